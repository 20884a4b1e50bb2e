// stillcut map: how far the dynamics map can be trusted between its postures, and what it predicts at one; and a map
// from a robot's description.
#include <iostream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>

#include "drivers/files/cell.hpp"
#include "drivers/files/dynamics_map_file.hpp"
#include "drivers/files/robot_file.hpp"
#include "models/leave_one_out.hpp"
#include "tools/cell_posture.hpp"
#include "tools/map_report.hpp"
#include "tools/output_file.hpp"
#include "tools/output_options.hpp"
#include "tools/progress.hpp"
#include "tools/robot_map.hpp"

namespace stillcut {
namespace {

struct MapOptions : OutputOptions {
  std::string cell, posture;
  std::string robot, postures, out;
  std::optional<InterpolationKind> interpolation;
};

// Writes what was asked for; a table for people where standard output is free.
template <class Print, class Csv, class Object>
void show(const MapOptions& options, const plot::Figure& figure, Print print, Csv csv, Object json) {
  if (!options.csv.empty()) {
    OutputFile file(options.csv);
    csv(file.stream());
    file.finish();
  }
  if (!options.plot.empty()) plot::write_figure(figure, options.plot);
  if (options.json) {
    std::cout << json().dump() << '\n';
  } else if (options.csv != "-") {
    print(std::cout);
  }
}

void report(const MapOptions& options, const CellDynamics& dynamics) {
  Progress progress("leaving postures out");
  const LeaveOneOut result =
      leave_one_out(dynamics.map, dynamics.interpolation, [&](double share) { progress.update(share); });
  progress.finish();
  show(
      options, report_figure(result), [&](std::ostream& out) { print_report(result, out); },
      [&](std::ostream& out) { write_report_csv(result, out); }, [&] { return report_to_json(result); });
}

void predict(const MapOptions& options, const CellDynamics& dynamics) {
  const DynamicsMap& map = dynamics.map;
  const PredictedPosture predicted = predict_posture(map, find_posture(map, options.posture), dynamics.interpolation);
  if (predicted.outside) std::cerr << "stillcut: " << options.cell << ": " << outside_map_text(predicted) << '\n';
  const ModalRefit refit = refit_modes(predicted.posture.modes);
  show(
      options, prediction_figure(predicted, find_posture(map, predicted.nearest)),
      [&](std::ostream& out) { print_prediction(predicted, refit, out); },
      [&](std::ostream& out) { write_prediction_csv(predicted, out); },
      [&] { return prediction_to_json(predicted, refit); });
}

// A map from the robot's description; with a cell, its measured map stands where it was measured and mends the rest.
void write_from_robot(const MapOptions& options) {
  const Arm arm = read_robot(options.robot);
  const RobotModes modes = robot_modes(arm, options.robot);
  CorrectedMap result{robot_postures(arm, options.robot, options.postures), {}};
  for (Posture& posture : result.map.postures) posture.modes = modes(posture);
  if (!options.cell.empty()) {
    const Cell cell = read_cell(options.cell, {.dbc = false, .bus = false});
    const DynamicsMap measured = read_cell_dynamics(cell).map;
    try {
      result = corrected_map(measured, result.map, modes);
    } catch (const std::invalid_argument& error) {
      throw InputError(cell.dynamics->map.string(), 0, error.what());
    }
  }
  write_dynamics_map(options.out, result.map);
  if (options.json) {
    std::cout << robot_map_to_json(result.map, result.matches).dump() << '\n';
  } else {
    print_robot_map(result.map, result.matches, std::cout);
  }
}

void run(const MapOptions& options) {
  if (!options.robot.empty()) return write_from_robot(options);
  if (options.cell.empty()) throw CLI::RequiredError("CELL");
  check_output_options(options);
  const Cell cell = read_cell(options.cell, {.dbc = false, .bus = false});
  CellDynamics dynamics = read_cell_dynamics(cell);
  if (options.interpolation) dynamics.interpolation.kind = *options.interpolation;
  try {
    options.posture.empty() ? report(options, dynamics) : predict(options, dynamics);
  } catch (const std::invalid_argument& error) {
    throw InputError(cell.dynamics->map.string(), 0, error.what());
  }
}

}  // namespace

void add_map_command(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("map",
                         "Can the dynamics map be trusted between its postures; what it predicts at one; "
                         "a map from a robot's description");
  const auto options = std::make_shared<MapOptions>();
  std::map<std::string, InterpolationKind> kinds;
  for (std::size_t i = 0; i < kInterpolationNames.size(); ++i)
    kinds.emplace(kInterpolationNames[i], static_cast<InterpolationKind>(i));
  command->add_option("CELL", options->cell, "Cell file; with --robot only where its map was measured");
  command->add_option("--posture", options->posture,
                      "Predict the modes there instead: id of a measured posture, j1,...,j6 in degrees, or x,y,z in mm "
                      "where the machine has no joints");
  command
      ->add_option("--interpolation", options->interpolation,
                   "For --posture: modal, frf or trend (default: the cell's). The report compares all three")
      ->transform(CLI::CheckedTransformer(kinds))
      ->needs("--posture");
  add_output_options(*command, *options, "Write the table", "Draw");
  CLI::Option* robot =
      command->add_option("--robot", options->robot, "Make a map from this URDF file (docs/robot.md) instead");
  CLI::Option* out = command->add_option("--out", options->out, "Folder for that map");
  command
      ->add_option("--postures", options->postures,
                   "Where: posture,j1_deg,... or posture,x_mm,y_mm,z_mm and perhaps redundancy_deg; default: the "
                   "robot's home")
      ->needs(robot);
  robot->needs(out);
  for (const char* other : {"--posture", "--interpolation", "--csv", "--plot"})
    robot->excludes(command->get_option(other));
  out->needs(robot);
  command->footer(
      "Every posture of the map is predicted from all the others, in four ways, and held beside its own measurement.\n"
      "Example: the report with a picture, then the modes at a posture that nobody measured:\n"
      "  stillcut map examples/demo-cell/cell.toml --plot map.svg\n"
      "  stillcut map examples/demo-cell/cell.toml --posture 10,-85,88,0,85,10\n"
      "Example: first modes of a robot that nobody has tapped yet:\n"
      "  stillcut map --robot examples/demo-robot/robot.urdf --postures examples/demo-robot/postures.csv --out map");
  command->callback([options] { run(*options); });
}

}  // namespace stillcut
