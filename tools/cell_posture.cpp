#include "tools/cell_posture.hpp"

#include <stdexcept>

#include "drivers/files/dynamics_map_file.hpp"
#include "models/linear_cut.hpp"

namespace stillcut {

CellDynamics read_cell_dynamics(const Cell& cell) {
  const DynamicsSettings& dynamics = require(cell, cell.dynamics, "dynamics");
  return {read_dynamics_map(dynamics.map), {.modal = dynamics.modal, .power = dynamics.power}};
}

Posture posture_of(const Cell& cell, const DynamicsMap& map, const std::string& asked) {
  const std::string& named = asked.empty() ? require(cell, cell.dynamics, "dynamics").posture : asked;
  const char* key = asked.empty() ? "dynamics.posture: " : "--posture: ";
  if (named.empty() && map.postures.size() == 1) return map.postures.front();
  if (named.empty()) {
    throw InputError(cell.file.string(), 0,
                     std::string(key) + "is missing; name one of the map's postures, for example \"" +
                         map.postures.front().id + "\"");
  }
  try {
    return find_posture(map, named);
  } catch (const std::invalid_argument& error) {
    throw InputError(cell.file.string(), 0, key + std::string(error.what()));
  }
}

PredictedPosture predicted_posture(const Cell& cell, const CellDynamics& dynamics, const std::string& asked) {
  const Posture posture = posture_of(cell, dynamics.map, asked);
  try {
    return predict_posture(dynamics.map, posture, dynamics.interpolation);
  } catch (const std::invalid_argument& error) {  // the posture was found: what cannot be is in the map or its settings
    throw InputError(require(cell, cell.dynamics, "dynamics").map.string(), 0, error.what());
  }
}

std::vector<std::string> stability_warnings(const Tool& tool, const Cut& cut, const PredictedPosture& predicted) {
  std::vector<std::string> lines = linear_cut_warnings(tool, cut);
  if (predicted.outside) {
    lines.push_back("posture " + predicted.posture.id + " lies outside the map, farther from posture \"" +
                    predicted.nearest + "\" than measured postures from each other; the lobes are an extrapolation");
  }
  return lines;
}

}  // namespace stillcut
