// stillcut coefficients: cutting coefficients of a tool in a material from slot tests, by the average-force method.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "drivers/files/cell.hpp"
#include "drivers/files/csv.hpp"
#include "tools/output_file.hpp"
#include "tools/output_options.hpp"
#include "tools/plot_coefficients.hpp"
#include "tools/slot_tests.hpp"

namespace stillcut {
namespace {

struct CoefficientsOptions : OutputOptions {
  std::string cell, table, cut, means;
  std::vector<std::string> forces, zero;
  std::optional<double> feed_direction_deg;
};

struct Identified {
  Tool tool;
  std::string material;  // its name
  std::vector<SlotTest> tests;
  RecordedTests recorded;
  SlotFit fit;
  std::vector<std::string> warnings;
};

struct CoefficientKey {
  const char* name;
  double unit;           // SI of one
  bool may_be_negative;  // in a cell file
};
constexpr std::array kCoefficientKeys{
    CoefficientKey{"ktc_mpa", 1e6, false},      CoefficientKey{"krc_mpa", 1e6, false},
    CoefficientKey{"kac_mpa", 1e6, true},       CoefficientKey{"kte_n_per_mm", 1e3, false},
    CoefficientKey{"kre_n_per_mm", 1e3, false}, CoefficientKey{"kae_n_per_mm", 1e3, true}};
constexpr std::array kForceNames{"fx", "fy", "fz"};

double value_of(const SixCoefficients& six, std::size_t i) {
  return six[static_cast<Eigen::Index>(i)] / kCoefficientKeys.at(i).unit;
}

RecordedSpan parse_span(const char* option, const std::string& text) {
  RecordedSpan span;
  const std::size_t colon = std::min(text.find(':'), text.size());
  const bool numbers = colon < text.size() && CLI::detail::lexical_cast(text.substr(0, colon), span.from) &&
                       CLI::detail::lexical_cast(text.substr(colon + 1), span.to) && std::isfinite(span.from) &&
                       std::isfinite(span.to) && span.from < span.to;
  if (!numbers) throw CLI::ValidationError(option, "'" + text + "' is not FROM:TO in seconds, FROM before TO");
  return span;
}

ForceWindows windows_of(const CoefficientsOptions& options) {
  ForceWindows windows;
  for (const std::string& text : options.zero) windows.zero.push_back(parse_span("--zero", text));
  if (windows.zero.size() > 2) throw CLI::ValidationError("--zero", "takes air before the cut and after it, no more");
  if (!options.cut.empty()) windows.cut = parse_span("--cut", options.cut);
  return windows;
}

// Without a cell's section, and where the option is not given, only the list can tell.
std::optional<double> feed_direction_of(const CoefficientsOptions& options, const Cell& cell) {
  if (options.feed_direction_deg) return deg_to_rad(*options.feed_direction_deg);
  if (cell.cut) return cell.cut->feed_direction;
  return std::nullopt;
}

Identified identify(const CoefficientsOptions& options) {
  const ForceWindows windows = windows_of(options);
  const Cell cell = read_cell(options.cell, {.dbc = false, .bus = false});
  Identified found;
  found.tool = require(cell, cell.tool, "tool");
  if (cell.material) found.material = cell.material->name;
  if (!options.table.empty()) found.tests = read_slot_tests(options.table);
  for (const std::string& path : options.forces) {
    const RecordedTests read = read_recorded_tests(path, found.tool, feed_direction_of(options, cell), windows);
    found.tests.insert(found.tests.end(), read.tests.begin(), read.tests.end());
    found.recorded.names.insert(found.recorded.names.end(), read.names.begin(), read.names.end());
    found.recorded.forces.insert(found.recorded.forces.end(), read.forces.begin(), read.forces.end());
    found.warnings.insert(found.warnings.end(), read.warnings.begin(), read.warnings.end());
  }
  const std::string source = options.table.empty() ? options.forces.front() : options.table;
  try {
    found.fit = fit_slot_coefficients(found.tool, found.tests);
  } catch (const std::invalid_argument& error) {
    throw InputError(source, 0, error.what());
  }
  for (const std::string& line : doubts(found.fit, found.tool, found.tests))
    found.warnings.push_back(std::string(source).append(": ").append(line));
  for (const std::string& line : found.warnings) std::cerr << "stillcut: " << line << '\n';
  return found;
}

void write_coefficients(const Identified& found, const std::string& name) {
  OutputFile file(name);
  file.stream() << "coefficient,value,standard_error\n";
  for (std::size_t i = 0; i < kCoefficientKeys.size(); ++i) {
    const std::array<std::string, 3> fields{kCoefficientKeys.at(i).name, csv_number(value_of(found.fit.value, i)),
                                            csv_number(value_of(found.fit.standard_error, i))};
    write_csv_row(file.stream(), fields);
  }
  file.finish();
}

void write_means(const Identified& found, const std::string& name) {
  OutputFile file(name);
  write_slot_tests(file.stream(), found.tests);
  file.finish();
}

void print_json(const Identified& found) {
  nlohmann::ordered_json object;
  for (std::size_t i = 0; i < kCoefficientKeys.size(); ++i) {
    const std::string key = kCoefficientKeys.at(i).name;
    object[key] = value_of(found.fit.value, i);
    object[key + "_se"] = value_of(found.fit.standard_error, i);
  }
  object["tests"] = found.tests.size();
  for (std::size_t axis = 0; axis < kForceNames.size(); ++axis) {
    object["r_squared"][kForceNames.at(axis)] = found.fit.axes.at(axis).r_squared;  // NaN becomes null
    object["scatter_n"][kForceNames.at(axis)] = found.fit.axes.at(axis).scatter;
  }
  object["warnings"] = found.warnings;
  std::cout << object.dump() << '\n';
}

std::string tests_text(const Identified& found) {
  std::set<double> feeds, depths;
  for (const SlotTest& test : found.tests) {
    feeds.insert(test.feed_per_tooth * 1e3);
    depths.insert(test.axial_depth * 1e3);
  }
  const char* shape = found.tool.shape == ToolShape::ball ? "ball end" : "end mill";
  std::array<char, 240> text{};
  std::snprintf(text.data(), text.size(), "%zu slots of a %g mm %s, %d teeth: %zu feeds per tooth, %g to %g mm; %g",
                found.tests.size(), found.tool.diameter * 1e3, shape, found.tool.teeth, feeds.size(), *feeds.begin(),
                *feeds.rbegin(), *depths.begin());
  std::string line = text.data();
  if (depths.size() > 1) line += " to " + csv_number(*depths.rbegin());
  return line + " mm deep";
}

// Two digits of the standard error; more of the value would be noise.
int decimals_of(double value, double error) {
  constexpr int kMost = 6;
  const double grain = error > 0.0 ? error : 1e-5 * std::abs(value);
  if (!(grain > 0.0)) return 1;
  return std::clamp(1 - static_cast<int>(std::floor(std::log10(grain))), 0, kMost);
}

// Without the sign of a value that the digits do not show.
std::string fixed(double value, int decimals) {
  const double grain = std::pow(10.0, decimals);
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.*f", decimals, std::round(value * grain) / grain + 0.0);
  return text.data();
}

std::string toml_string(const std::string& text) { return nlohmann::json(text).dump(); }  // JSON's escapes are TOML's

void print_table(const Identified& found) {
  std::printf("%s\n", tests_text(found).c_str());
  for (std::size_t i = 0; i < found.recorded.names.size(); ++i) {
    const SteadyForce& steady = found.recorded.forces[i];
    std::printf("%s: mean over %d turns, %g to %g s\n", found.recorded.names[i].c_str(), steady.turns, steady.span.from,
                steady.span.to);
  }
  std::printf("\n%-14s %12s  ± standard error\n", "", "value");
  for (std::size_t i = 0; i < kCoefficientKeys.size(); ++i) {
    const double value = value_of(found.fit.value, i), error = value_of(found.fit.standard_error, i);
    std::printf("%-14s %12s  ± %.2g\n", kCoefficientKeys.at(i).name, fixed(value, decimals_of(value, error)).c_str(),
                error);
  }
  std::printf("\n");
  for (std::size_t axis = 0; axis < kForceNames.size(); ++axis) {
    const AxisFit& fit = found.fit.axes.at(axis);
    if (std::isnan(fit.r_squared)) continue;
    std::printf("%s: R² %.4f, scatter of a mean force %.3g N\n", kForceNames.at(axis), fit.r_squared, fit.scatter);
  }
  std::printf("\n[material]\nname = %s\n", toml_string(found.material.empty() ? "unnamed" : found.material).c_str());
  for (std::size_t i = 0; i < kCoefficientKeys.size(); ++i) {
    const double value = value_of(found.fit.value, i);
    const int decimals = std::max(1, decimals_of(value, value_of(found.fit.standard_error, i)));
    const bool taken = value >= 0.0 || kCoefficientKeys.at(i).may_be_negative;
    std::printf(taken ? "%s = %s\n" : "%s = 0.0  # fitted %s\n", kCoefficientKeys.at(i).name,
                fixed(value, decimals).c_str());
  }
}

void run(const CoefficientsOptions& options) {
  check_output_options(options);
  if (options.table.empty() && options.forces.empty())
    throw CLI::ValidationError("FILE", "give a table of mean forces, or recordings with --forces");
  if (options.forces.empty() && !(options.zero.empty() && options.cut.empty() && !options.feed_direction_deg))
    throw CLI::ValidationError("--forces", "--zero, --cut and --feed-direction are said of recordings");
  if (options.means == "-" && (options.json || options.csv == "-"))
    throw CLI::ValidationError("--means", "cannot share standard output with --json or --csv -");
  const Identified found = identify(options);
  if (!options.means.empty()) write_means(found, options.means);
  if (!options.csv.empty()) write_coefficients(found, options.csv);
  if (!options.plot.empty())
    plot::write_figure(slot_figure(tests_text(found), found.tool, found.tests, found.fit), options.plot);
  if (options.json) print_json(found);
  if (!options.json && options.csv.empty() && options.means != "-") print_table(found);
}

}  // namespace

void add_coefficients_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("coefficients", "Cutting coefficients from slot tests, with standard errors");
  const auto options = std::make_shared<CoefficientsOptions>();
  command->add_option("CELL", options->cell, "Cell file; its [tool] made the slots")->required();
  command->add_option("FILE", options->table,
                      "CSV file of mean forces on the tool in the feed frame, columns "
                      "feed_per_tooth_mm,axial_depth_mm,fx_mean_n,fy_mean_n,fz_mean_n");
  command->add_option("--forces", options->forces,
                      "Or recordings: a list, columns file,feed_per_tooth_mm,axial_depth_mm,spindle_speed_rpm, or a "
                      "folder with the list tests.csv; each file has columns time_s,fx_n,fy_n,fz_n, workpiece axes");
  command
      ->add_option("--zero", options->zero,
                   "FROM:TO in s, air before the cut: its mean force is taken off; again for air after the cut, then "
                   "drift is too")
      ->allow_extra_args(false);
  command->add_option("--cut", options->cut, "FROM:TO in s, where to take the mean (default: the steady cut is found)");
  command->add_option(
      "--feed-direction", options->feed_direction_deg,
      "Of recordings whose list has no feed_direction_deg, degrees from +X toward +Y (default: the cell's)");
  command->add_option("--means", options->means, "Write the mean forces, as FILE has them; - is standard output");
  add_output_options(*command, *options, "Write the six coefficients with their standard errors",
                     "Draw mean forces over feed per tooth, and the fit");
  command->footer(
      "Example: from a table, and from what a dynamometer recorded:\n"
      "  stillcut coefficients examples/demo-cell/cell.toml examples/demo-cell/slots.csv --plot slots.svg\n"
      "  stillcut coefficients cell.toml --forces slots/ --zero 0:0.5 --means slots.csv");
  command->callback([options] { run(*options); });
}

}  // namespace stillcut
