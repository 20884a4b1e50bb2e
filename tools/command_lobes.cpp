// stillcut lobes: the stability lobe diagram at a posture: how deep may be cut at which spindle speed.
#include <algorithm>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>

#include "drivers/files/cell.hpp"
#include "tools/cut_points.hpp"
#include "tools/lobe_study.hpp"
#include "tools/output_file.hpp"
#include "tools/output_options.hpp"
#include "tools/plot_lobes.hpp"
#include "tools/progress.hpp"

namespace stillcut {
namespace {

constexpr int kDefaultCount = 201;

struct LobesOptions : OutputOptions {
  std::string cell, speed, cuts, tolerance;
  std::vector<std::string> postures;
  std::vector<double> feed_directions_deg;
  std::string method = "sdm";
  double max_depth_mm = 20.0;
  std::optional<double> confidence;
  int samples = Confidence{}.samples;
};

// "MIN:MAX:COUNT" in rpm.
std::vector<double> parse_speeds(const std::string& text) {
  const std::vector<std::string> parts = CLI::detail::split(text, ':');
  double low = 0.0, high = 0.0;
  int count = 0;
  if (parts.size() != 3 || !CLI::detail::lexical_cast(parts[0], low) || !CLI::detail::lexical_cast(parts[1], high) ||
      !CLI::detail::lexical_cast(parts[2], count)) {
    throw CLI::ValidationError("--speed", "'" + text + "' is not MIN:MAX:COUNT, such as 2800:3800:101");
  }
  constexpr int kMostSpeeds = 1'000'000;
  if (count > kMostSpeeds) throw CLI::ValidationError("--speed", "COUNT must be at most 1000000");
  try {
    return equally_spaced_speeds(rpm_to_rad_s(low), rpm_to_rad_s(high), count);
  } catch (const std::invalid_argument& error) {
    throw CLI::ValidationError("--speed", error.what());
  }
}

std::vector<double> speeds_of(const Cell& cell, const LobesOptions& options) {
  if (!options.speed.empty()) return parse_speeds(options.speed);
  const SpindleLimits& spindle = require(cell, cell.spindle, "spindle");
  return equally_spaced_speeds(spindle.min_speed, spindle.max_speed, kDefaultCount);
}

// "frequency=0.03,damping=0.2,stiffness=0.1,ktc=0.1"; what is not named keeps its default.
ToleranceAsked parse_tolerance(const std::string& text) {
  ToleranceAsked tolerance;
  const std::pair<const char*, std::optional<double>*> names[] = {{"frequency", &tolerance.frequency},
                                                                  {"damping", &tolerance.damping},
                                                                  {"stiffness", &tolerance.stiffness},
                                                                  {"ktc", &tolerance.ktc}};
  if (text.empty()) return tolerance;
  for (const std::string& part : CLI::detail::split(text, ',')) {
    const std::size_t equals = std::min(part.find('='), part.size());
    const auto* name = std::find_if(std::begin(names), std::end(names),
                                    [&](const auto& candidate) { return part.substr(0, equals) == candidate.first; });
    double value = 0.0;
    if (name == std::end(names) || equals == part.size() ||
        !CLI::detail::lexical_cast(part.substr(equals + 1), value) || !(value >= 0.0 && value < 1.0)) {
      throw CLI::ValidationError("--tolerance", "'" + part +
                                                    "' is not frequency=, damping=, stiffness= or ktc= with a relative "
                                                    "standard deviation from 0 to below 1");
    }
    *name->second = value;
  }
  return tolerance;
}

LobeQuestion question_of(const Cell& cell, const LobesOptions& options) {
  LobeQuestion question;
  question.postures = options.postures;
  for (const double direction : options.feed_directions_deg) {
    question.feed_directions.push_back(deg_to_rad(direction));
  }
  question.speeds = speeds_of(cell, options);
  question.settings.method = options.method == "zoa" ? LobeMethod::zeroth_order : LobeMethod::floquet;
  question.settings.max_depth = options.max_depth_mm * 1e-3;
  question.tolerance = parse_tolerance(options.tolerance);
  if (options.confidence) question.confidence = Confidence{*options.confidence, options.samples};
  return question;
}

void check_usage(const LobesOptions& options) {
  check_output_options(options);
  if (!options.tolerance.empty() && !options.confidence) {
    throw CLI::ValidationError("--tolerance", "goes with --confidence");
  }
  if (!options.cuts.empty() && options.plot.empty()) throw CLI::ValidationError("--cuts", "goes with --plot");
  const std::size_t curves =
      std::max<std::size_t>(1, options.postures.size()) * std::max<std::size_t>(1, options.feed_directions_deg.size());
  if (!options.plot.empty() && curves > kMostLobeCurves) {
    throw CLI::ValidationError("--plot", "a picture holds at most " + std::to_string(kMostLobeCurves) +
                                             " curves; name fewer postures or feed directions");
  }
  if (options.confidence && options.samples * (1.0 - *options.confidence) < 0.5) {
    throw CLI::ValidationError("--samples", "too few for this confidence; at least 0.5/(1 - confidence) are needed");
  }
}

void run(const LobesOptions& options) {
  check_usage(options);
  const Cell cell = read_cell(options.cell, {.dbc = false, .bus = false});
  const LobeQuestion question = question_of(cell, options);
  std::vector<MeasuredCut> cuts;
  if (!options.cuts.empty()) cuts = read_measured_cuts(options.cuts);
  Progress progress("lobes");
  const LobeStudy study = study_lobes(cell, question, [&](double share) { progress.update(share); });
  progress.finish();
  for (const std::string& line : study.warnings) std::cerr << "stillcut: " << options.cell << ": " << line << '\n';

  const bool nothing_asked = options.csv.empty() && options.plot.empty() && !options.json;
  if (nothing_asked || !options.csv.empty()) {
    OutputFile file(nothing_asked ? "-" : options.csv);
    write_lobes_csv(study, file.stream());
    file.finish();
  }
  if (!options.plot.empty()) plot::write_figure(lobe_figure(study, cuts), options.plot);
  if (options.json) {
    std::cout << lobes_json(study).dump() << '\n';
  } else if (!nothing_asked && options.csv != "-") {
    print_lobes_summary(study, std::cout);
  }
}

}  // namespace

void add_lobes_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("lobes", "How deep may be cut at which spindle speed: the stability lobes");
  const auto options = std::make_shared<LobesOptions>();
  command->add_option("CELL", options->cell, "Cell file")->required();
  command
      ->add_option("--posture", options->postures,
                   "Id of a measured posture, j1,...,j6 in degrees, or x,y,z in mm where the machine has no joints "
                   "(default: the cell's); again for a further one")
      ->allow_extra_args(false);
  command
      ->add_option("--feed-direction", options->feed_directions_deg,
                   "Degrees from +X toward +Y (default: the cell's); again for a further one")
      ->allow_extra_args(false);
  command->add_option("--method", options->method, "sdm: converged Floquet solution; zoa: zeroth order, a first look")
      ->capture_default_str()
      ->check(CLI::IsMember({"sdm", "zoa"}));
  command->add_option("--speed", options->speed, "MIN:MAX:COUNT in rpm (default: 201 over the spindle's range)");
  command->add_option("--max-depth", options->max_depth_mm, "Largest depth to look at, mm")
      ->capture_default_str()
      ->check(CLI::Range(1e-6, 1e4).description(""));
  command
      ->add_option("--confidence", options->confidence,
                   "Probability, 0.5 to 0.99: adds the depth that is stable with it, as a band")
      ->check(CLI::Range(0.5, 0.99).description(""));
  command->add_option("--tolerance", options->tolerance,
                      "Relative standard deviations of what is known of the cell, as frequency=0.03,damping=0.2,"
                      "stiffness=0.1,ktc=0.1 (default: the map's leave-one-out scatter, ktc=0.1; these where the map "
                      "is too small to tell)");
  command->add_option("--samples", options->samples, "Diagrams computed for the band")
      ->capture_default_str()
      ->check(CLI::Range(1, 100000).description(""));
  command->add_option("--cuts", options->cuts,
                      "CSV file of cuts made, spindle_speed_rpm,axial_depth_mm,verdict (stable, marginal or chatter), "
                      "to be drawn on top");
  add_output_options(*command, *options, "Write the diagram, to standard output without any output option",
                     "Draw the diagram");
  command->footer(
      "Examples: the lobes for a feed along +Y, as a table and a picture; two feeds at two postures in one picture:\n"
      "  stillcut lobes examples/demo-cell/cell.toml --feed-direction 90 --speed 6000:14000:101 \\\n"
      "    --csv lobes.csv --plot lobes.svg\n"
      "  stillcut lobes examples/demo-cell/cell.toml --posture home --posture far --feed-direction 0 \\\n"
      "    --feed-direction 90 --plot lobes.png");
  command->callback([options] { run(*options); });
}

}  // namespace stillcut
