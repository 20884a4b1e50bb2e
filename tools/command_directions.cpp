// stillcut directions: how deep may be cut in which feed direction, at every posture of the map.
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <thread>

#include "drivers/files/cell.hpp"
#include "models/lobes.hpp"
#include "tools/direction_study.hpp"
#include "tools/output_file.hpp"
#include "tools/output_options.hpp"
#include "tools/progress.hpp"

namespace stillcut {
namespace {

constexpr int kSpeeds = 201;

struct DirectionsOptions : OutputOptions {
  std::string cell;
  std::vector<std::string> postures;
  double step_deg = 10.0, max_depth_mm = 20.0;
  std::string method = "sdm";
  std::string milling;  // empty: the cell's
  std::optional<double> radial_depth_mm;
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

void run(const DirectionsOptions& options) {
  check_output_options(options);
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
  const DirectionsResult result = study_directions(cell, cut_of(cell, options), options.postures, study, options.jobs,
                                                   [&](double share) { progress.update(share); });
  progress.finish();
  for (const std::string& line : result.warnings) std::cerr << "stillcut: " << options.cell << ": " << line << '\n';

  if (!options.csv.empty()) {
    OutputFile file(options.csv);
    write_directions_csv(result, file.stream());
    file.finish();
  }
  if (!options.plot.empty()) plot::write_figure(directions_figure(result), options.plot);
  if (options.json) {
    std::cout << directions_json(result).dump() << '\n';
  } else if (options.csv != "-") {
    print_directions_summary(result, std::cout);
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
  command->add_option("--jobs", options->jobs, "Threads (default: one a processor)")->check(CLI::Range(1, 256));
  add_output_options(*command, *options, "Write posture,feed_direction_deg,a_abs_mm,a_pocket_mm,pocket_rpm",
                     "Draw the limits as a polar diagram");
  command->footer(
      "a_abs: the depth that is stable at every speed of [spindle]; a_pocket: the deepest at any one of them.\n"
      "Example:\n"
      "  stillcut directions examples/robot-cell/cell.toml --step 15 --csv directions.csv --plot directions.svg");
  command->callback([options] { run(*options); });
}

}  // namespace stillcut
