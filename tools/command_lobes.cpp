// stillcut lobes: the stability lobe diagram at a posture: how deep may be cut at which spindle speed.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>

#include "drivers/files/cell.hpp"
#include "drivers/files/csv.hpp"
#include "drivers/files/dynamics_map_file.hpp"
#include "models/interpolation.hpp"
#include "models/linear_cut.hpp"
#include "models/lobes.hpp"
#include "tools/commands.hpp"
#include "tools/plot_lobes.hpp"
#include "tools/progress.hpp"

namespace stillcut {
namespace {

constexpr int kDefaultCount = 201;

struct LobesOptions {
  std::string cell, posture, speed, csv, plot;
  std::optional<double> feed_direction_deg;
  std::string method = "sdm";
  double max_depth_mm = 20.0;
  bool json = false;
};

LobeMethod method_of(const LobesOptions& options) {
  return options.method == "zoa" ? LobeMethod::zeroth_order : LobeMethod::floquet;
}

struct Lobes {
  PredictedPosture predicted;
  Cut cut;
  std::vector<double> speeds;
  std::vector<DepthLimit> limits;
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

PredictedPosture predict(const Cell& cell, const LobesOptions& options) {
  const DynamicsSettings& dynamics = require(cell, cell.dynamics, "dynamics");
  const DynamicsMap map = read_dynamics_map(dynamics.map);
  std::string asked = options.posture.empty() ? dynamics.posture : options.posture;
  if (asked.empty() && map.postures.size() == 1) asked = map.postures.front().id;
  if (asked.empty()) {
    throw InputError(options.cell, 0, "dynamics.posture: is missing; set it, or name a posture with --posture");
  }
  try {
    return predict_posture(map, find_posture(map, asked), {.modal = dynamics.modal, .power = dynamics.power});
  } catch (const std::invalid_argument& error) {
    throw InputError(dynamics.map.string(), 0, error.what());
  }
}

void warn(const LobesOptions& options, const std::string& line) {
  std::cerr << "stillcut: " << options.cell << ": " << line << '\n';
}

Lobes compute(const LobesOptions& options) {
  const Cell cell = read_cell(options.cell, {.dbc = false, .bus = false});
  const Tool& tool = require(cell, cell.tool, "tool");
  const Material& material = require(cell, cell.material, "material");
  Lobes lobes;
  lobes.cut = require(cell, cell.cut, "cut");
  if (options.feed_direction_deg) lobes.cut.feed_direction = deg_to_rad(*options.feed_direction_deg);
  lobes.speeds = speeds_of(cell, options);
  lobes.predicted = predict(cell, options);
  for (const std::string& line : linear_cut_warnings(tool, lobes.cut)) warn(options, line);
  if (lobes.predicted.outside) {
    warn(options, "posture lies outside the map, farther from posture \"" + lobes.predicted.nearest +
                      "\" than measured postures from each other; the lobes are an extrapolation");
  }
  Progress progress("lobes");
  try {
    lobes.limits = depth_limits(tool, material, lobes.cut, lobes.predicted.posture.modes, lobes.speeds,
                                {.method = method_of(options), .max_depth = options.max_depth_mm * 1e-3},
                                [&](double share) { progress.update(share); });
  } catch (const std::invalid_argument& error) {
    throw InputError(options.cell, 0, error.what());
  }
  return lobes;
}

// Speeds as users gave them: without the rounding of the way to rad/s and back.
double clean_rpm(double speed) { return std::round(rad_s_to_rpm(speed) * 1e6) / 1e6; }

void write_csv(const Lobes& lobes, std::ostream& out) {
  out << "spindle_speed_rpm,a_lim_mm,chatter_frequency_hz\n";
  for (std::size_t i = 0; i < lobes.limits.size(); ++i) {
    const DepthLimit& limit = lobes.limits[i];
    const std::string fields[] = {csv_number(clean_rpm(lobes.speeds[i])), csv_number(limit.depth * 1e3),
                                  csv_number_or_empty(limit.chatter_frequency / kTwoPi)};
    write_csv_row(out, fields);
  }
}

void write_csv(const Lobes& lobes, const std::string& name) {
  if (name == "-") return write_csv(lobes, std::cout);
  std::ofstream file(name, std::ios::binary);
  if (!file) throw InputError(name, 0, "cannot be written");
  write_csv(lobes, file);
  if (!file.flush()) throw InputError(name, 0, "cannot be written to the end; is the disk full?");
}

// The depth as JSON can hold it: a number, or "inf" and "nan" as in the CSV.
nlohmann::ordered_json json_depth(double depth) {
  if (std::isfinite(depth)) return depth * 1e3;
  return csv_number(depth);
}

nlohmann::ordered_json to_json(const Lobes& lobes, const LobesOptions& options) {
  const PredictedPosture& predicted = lobes.predicted;
  nlohmann::ordered_json modes = nlohmann::json::array(), points = nlohmann::json::array();
  for (const Mode& mode : predicted.posture.modes) {
    modes.push_back({{"frequency_hz", mode.natural_frequency / kTwoPi},
                     {"damping_ratio", mode.damping_ratio},
                     {"stiffness_n_per_m", mode.stiffness},
                     {"direction", mode.direction}});
  }
  double error = 0.0;
  for (std::size_t i = 0; i < lobes.limits.size(); ++i) {
    const DepthLimit& limit = lobes.limits[i];
    const bool finite = std::isfinite(limit.depth);
    constexpr const char* kKinds[] = {"hopf", "flip", "fold"};
    points.push_back({{"spindle_speed_rpm", clean_rpm(lobes.speeds[i])},
                      {"a_lim_mm", json_depth(limit.depth)},
                      {"chatter_frequency_hz", finite ? nlohmann::json(limit.chatter_frequency / kTwoPi) : nullptr},
                      {"instability", finite ? nlohmann::json(kKinds[static_cast<int>(limit.instability)]) : nullptr}});
    error = std::max(error, limit.error_estimate);
  }
  return {{"posture", predicted.posture.id},
          {"nearest_posture", predicted.nearest},
          {"outside_map", predicted.outside},
          {"method", options.method},
          {"feed_direction_deg", rad_to_deg(lobes.cut.feed_direction)},
          {"max_depth_mm", options.max_depth_mm},
          {"relative_error_estimate", method_of(options) == LobeMethod::floquet ? nlohmann::json(error) : nullptr},
          {"modes", modes},
          {"points", points}};
}

// The lowest and the highest limit in a line for people.
void summarise(const Lobes& lobes) {
  const auto depth = [&](std::size_t i) { return std::isnan(lobes.limits[i].depth) ? 0.0 : lobes.limits[i].depth; };
  std::size_t lowest = 0, highest = 0;
  for (std::size_t i = 1; i < lobes.limits.size(); ++i) {
    if (depth(i) < depth(lowest)) lowest = i;
    if (depth(i) > depth(highest)) highest = i;
  }
  std::printf("posture %s: lowest limit %.3g mm at %.0f rpm, highest %.3g mm at %.0f rpm\n",
              lobes.predicted.posture.id.c_str(), depth(lowest) * 1e3, rad_s_to_rpm(lobes.speeds[lowest]),
              depth(highest) * 1e3, rad_s_to_rpm(lobes.speeds[highest]));
}

void run(const LobesOptions& options) {
  if (options.json && options.csv == "-") {
    throw CLI::ValidationError("--json", "cannot share standard output with --csv -");
  }
  const Lobes lobes = compute(options);
  const bool nothing_asked = options.csv.empty() && options.plot.empty() && !options.json;
  if (nothing_asked || !options.csv.empty()) write_csv(lobes, nothing_asked ? "-" : options.csv);
  if (!options.plot.empty()) {
    const double direction = rad_to_deg(lobes.cut.feed_direction);
    LobePicture picture{.title = "Stability lobes, posture " + lobes.predicted.posture.id,
                        .subtitle = "feed direction " + csv_number(std::round(direction * 100.0) / 100.0) + "°, " +
                                    (method_of(options) == LobeMethod::floquet ? "Floquet" : "zeroth order"),
                        .speeds = lobes.speeds,
                        .limits = lobes.limits,
                        .max_depth = options.max_depth_mm * 1e-3,
                        .cut_speed = lobes.cut.spindle_speed,
                        .cut_depth = lobes.cut.axial_depth};
    plot::write_figure(lobe_figure(picture), options.plot);
  }
  if (options.json) {
    std::cout << to_json(lobes, options).dump() << '\n';
  } else if (!nothing_asked && options.csv != "-") {
    summarise(lobes);
  }
}

}  // namespace

void add_lobes_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("lobes", "How deep may be cut at which spindle speed: the stability lobes");
  const auto options = std::make_shared<LobesOptions>();
  command->add_option("CELL", options->cell, "Cell file")->required();
  command->add_option("--posture", options->posture,
                      "Id of a measured posture, j1,...,j6 in degrees, or x,y,z in mm where the machine has no joints "
                      "(default: the cell's)");
  command->add_option("--feed-direction", options->feed_direction_deg,
                      "Degrees from +X toward +Y (default: the cell's)");
  command->add_option("--method", options->method, "sdm: converged Floquet solution; zoa: zeroth order, a first look")
      ->capture_default_str()
      ->check(CLI::IsMember({"sdm", "zoa"}));
  command->add_option("--speed", options->speed, "MIN:MAX:COUNT in rpm (default: 201 over the spindle's range)");
  command->add_option("--max-depth", options->max_depth_mm, "Largest depth to look at, mm")
      ->capture_default_str()
      ->check(CLI::Range(1e-6, 1e4).description(""));
  command->add_option("--csv", options->csv, "Write the diagram; - is standard output (so without any output option)");
  command->add_option("--plot", options->plot, "Draw the diagram to a .svg or .png file");
  command->add_flag("--json", options->json, "One JSON object on standard output");
  command->footer(
      "Example: the lobes for a feed along +Y, as a table and a picture:\n"
      "  stillcut lobes examples/demo-cell/cell.toml --feed-direction 90 --speed 2800:3800:101 \\\n"
      "    --csv lobes.csv --plot lobes.svg");
  command->callback([options] { run(*options); });
}

}  // namespace stillcut
