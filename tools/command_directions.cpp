// stillcut directions: how deep may be cut in which feed direction, at every posture of the map.
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <thread>

#include "drivers/files/cell.hpp"
#include "models/lobes.hpp"
#include "tools/direction_choice.hpp"
#include "tools/direction_study.hpp"
#include "tools/location_study.hpp"
#include "tools/output_file.hpp"
#include "tools/output_options.hpp"
#include "tools/progress.hpp"

namespace stillcut {
namespace {

constexpr int kSpeeds = 201;
constexpr double kMostVariations = 1e5;

struct DirectionsOptions : OutputOptions {
  std::string cell;
  std::vector<std::string> postures;
  double step_deg = 10.0, max_depth_mm = 20.0;
  std::string method = "sdm";
  std::string milling;  // empty: the cell's
  std::optional<double> radial_depth_mm, grid_mm;
  std::string redundancy, placement, robot;
  int jobs = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
};

Cut cut_of(const Cell& cell, const DirectionsOptions& options) {
  Cut cut = require(cell, cell.cut, "cut");
  const Tool& tool = require(cell, cell.tool, "tool");
  if (options.radial_depth_mm) cut.radial_depth = *options.radial_depth_mm * 1e-3;
  if (cut.radial_depth > tool.diameter)
    throw CLI::ValidationError("--radial-depth", "is more than the tool's diameter");
  if (options.milling == "down" || options.milling == "alternating") cut.milling = Milling::down;
  if (options.milling == "up") cut.milling = Milling::up;
  return cut;
}

// SI units of what an option lists.
std::vector<double> values_of(const char* option, const std::string& text, double (*to_si)(double)) {
  try {
    std::vector<double> values = equally_spaced_values(text);
    for (double& value : values) value = to_si(value);
    return values;
  } catch (const std::invalid_argument& error) {
    throw CLI::ValidationError(option, error.what());
  }
}

VariationsAsked variations_of(const DirectionsOptions& options) {
  VariationsAsked asked{{}, {}, {}, options.robot};
  if (!options.redundancy.empty()) {
    asked.redundancies = values_of("--redundancy", options.redundancy, deg_to_rad);
    if (asked.redundancies->back() - asked.redundancies->front() > kTwoPi)
      throw CLI::ValidationError("--redundancy", "is more than a whole turn");
  }
  if (!options.placement.empty()) {
    const auto comma = options.placement.find(',');
    if (comma == std::string::npos)
      throw CLI::ValidationError("--placement", "'" + options.placement +
                                                    "' is not X_MIN:X_MAX:COUNT,Y_MIN:Y_MAX:COUNT, such as "
                                                    "-100:100:5,0:0:1");
    const auto metres = [](double mm) { return 1e-3 * mm; };
    asked.xs = values_of("--placement", options.placement.substr(0, comma), metres);
    asked.ys = values_of("--placement", options.placement.substr(comma + 1), metres);
  }
  const auto count = [](const auto& values) { return values ? static_cast<double>(values->size()) : 1.0; };
  if (count(asked.redundancies) * count(asked.xs) * count(asked.ys) > kMostVariations)
    throw CLI::ValidationError("--redundancy and --placement", "are more than 100000 combinations");
  if (!options.robot.empty() && !asked.any())
    throw CLI::ValidationError("--robot", "tells how to turn and move; add --redundancy or --placement");
  return asked;
}

// What --grid or --posture names; none: all of the map.
std::vector<std::string> postures_of(const Cell& cell, const DirectionsOptions& options) {
  if (!options.grid_mm) return options.postures;
  std::vector<std::string> places;
  for (const PredictedPosture& place : study_locations(cell, read_cell_dynamics(cell), {}, *options.grid_mm * 1e-3))
    places.push_back(place.posture.id);  // as --posture takes places
  return places;
}

void run(const DirectionsOptions& options) {
  check_output_options(options);
  const VariationsAsked asked = variations_of(options);
  const Cell cell = read_cell(options.cell, {.dbc = false, .bus = false});
  const SpindleLimits& spindle = require(cell, cell.spindle, "spindle");
  DirectionStudy study;
  study.directions = directions_around(deg_to_rad(options.step_deg));
  study.speeds = equally_spaced_speeds(spindle.min_speed, spindle.max_speed, kSpeeds);
  study.method = options.method == "sdm"   ? DirectionMethod::floquet
                 : options.method == "zoa" ? DirectionMethod::zeroth_order
                                           : DirectionMethod::paper;
  study.sense = options.milling == "alternating" ? CutSense::alternating : CutSense::as_set;
  study.max_depth = options.max_depth_mm * 1e-3;
  Progress progress("directions");
  const Cut cut = cut_of(cell, options);
  const DirectionsResult result = study_directions(cell, cut, postures_of(cell, options), asked, study, options.jobs,
                                                   [&](double share) { progress.update(share); });
  progress.finish();
  for (const std::string& line : result.warnings) std::cerr << "stillcut: " << options.cell << ": " << line << '\n';

  if (!options.csv.empty()) {
    OutputFile file(options.csv);
    write_directions_csv(result, file.stream());
    file.finish();
  }
  if (!options.plot.empty()) {
    plot::write_figure(asked.any() ? variations_figure(result, cut.feed_direction) : directions_figure(result),
                       options.plot);
  }
  if (options.json) {
    nlohmann::ordered_json json = directions_json(result);
    if (asked.any()) json.update(choice_json(result));
    std::cout << json.dump() << '\n';
  } else if (options.csv != "-") {
    asked.any() ? print_choice(result, std::cout) : print_directions_summary(result, std::cout);
  }
}

}  // namespace

void add_directions_command(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("directions", "How deep may be cut in which feed direction, at every posture of the map");
  const auto options = std::make_shared<DirectionsOptions>();
  command->add_option("CELL", options->cell, "Cell file")->required();
  command->add_option("--step", options->step_deg, "Degrees from one direction to the next, around the whole circle")
      ->capture_default_str()
      ->check(CLI::Range(0.1, 180.0).description(""));
  command
      ->add_option("--posture", options->postures,
                   "Id of a measured posture, j1,...,j6 in degrees, or x,y,z in mm where the machine has no joints "
                   "(default: every posture of the map); again for a further one")
      ->allow_extra_args(false);
  command
      ->add_option("--grid", options->grid_mm,
                   "Places so many mm apart, predicted, instead of the map's postures (maps without joints)")
      ->check(CLI::Range(0.1, 1e4).description(""))
      ->excludes("--posture");
  command
      ->add_option("--method", options->method,
                   "sdm: converged Floquet solution; zoa: zeroth order; paper: zeroth order with the receptance "
                   "projected as in Tunc and Stoddart 2017, only to compare with that paper")
      ->capture_default_str()
      ->check(CLI::IsMember({"sdm", "zoa", "paper"}));
  command->add_option("--milling", options->milling, "down, up, or alternating as in zig-zag (default: the cell's)")
      ->check(CLI::IsMember({"down", "up", "alternating"}));
  command->add_option("--radial-depth", options->radial_depth_mm, "mm (default: the cell's)")
      ->check(CLI::Range(1e-6, 1e4).description(""));
  command->add_option("--max-depth", options->max_depth_mm, "Largest depth to look at, mm")
      ->capture_default_str()
      ->check(CLI::Range(1e-6, 1e4).description(""));
  command->add_option("--redundancy", options->redundancy,
                      "MIN:MAX:COUNT in degrees: the robot turned about the tool's axis so much from each posture");
  command->add_option("--placement", options->placement,
                      "X_MIN:X_MAX:COUNT,Y_MIN:Y_MAX:COUNT in mm: the part moved so much before the robot");
  command->add_option("--robot", options->robot,
                      "URDF file (docs/robot.md) of the robot that turns and moves, where the map has joints");
  command->add_option("--jobs", options->jobs, "Threads (default: one a processor)")->check(CLI::Range(1, 256));
  add_output_options(*command, *options, "Write posture,feed_direction_deg,a_abs_mm,a_pocket_mm,pocket_rpm",
                     "Draw the limits as a polar diagram, or over redundancy angle and placement");
  command->footer(
      "a_abs: the depth that is stable at every speed of [spindle]; a_pocket: the deepest at any one of them.\n"
      "Example:\n"
      "  stillcut directions examples/robot-cell/cell.toml --step 15 --csv directions.csv --plot directions.svg\n"
      "Example: which turn of the robot about the tool's axis allows the deepest cut:\n"
      "  stillcut directions examples/demo-robot/turned.toml --robot examples/demo-robot/robot.urdf\n"
      "      --redundancy -40:40:9 --method zoa");
  command->callback([options] { run(*options); });
}

}  // namespace stillcut
