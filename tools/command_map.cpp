// stillcut map: how far the dynamics map can be trusted between its postures, and what it predicts at one.
#include <iostream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>

#include "drivers/files/cell.hpp"
#include "models/leave_one_out.hpp"
#include "tools/cell_posture.hpp"
#include "tools/map_report.hpp"
#include "tools/output_file.hpp"
#include "tools/output_options.hpp"
#include "tools/progress.hpp"

namespace stillcut {
namespace {

struct MapOptions : OutputOptions {
  std::string cell, posture;
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

void run(const MapOptions& options) {
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
      app.add_subcommand("map", "Can the dynamics map be trusted between its postures; what it predicts at one");
  const auto options = std::make_shared<MapOptions>();
  std::map<std::string, InterpolationKind> kinds;
  for (std::size_t i = 0; i < kInterpolationNames.size(); ++i)
    kinds.emplace(kInterpolationNames[i], static_cast<InterpolationKind>(i));
  command->add_option("CELL", options->cell, "Cell file")->required();
  command->add_option("--posture", options->posture,
                      "Predict the modes there instead: id of a measured posture, j1,...,j6 in degrees, or x,y,z in mm "
                      "where the machine has no joints");
  command
      ->add_option("--interpolation", options->interpolation,
                   "For --posture: modal, frf or trend (default: the cell's). The report compares all three")
      ->transform(CLI::CheckedTransformer(kinds))
      ->needs("--posture");
  add_output_options(*command, *options, "Write the table", "Draw");
  command->footer(
      "Every posture of the map is predicted from all the others, in four ways, and held beside its own measurement.\n"
      "Example: the report with a picture, then the modes at a posture that nobody measured:\n"
      "  stillcut map examples/demo-cell/cell.toml --plot map.svg\n"
      "  stillcut map examples/demo-cell/cell.toml --posture 10,-85,88,0,85,10");
  command->callback([options] { run(*options); });
}

}  // namespace stillcut
