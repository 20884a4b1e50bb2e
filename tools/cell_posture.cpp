#include "tools/cell_posture.hpp"

#include <array>
#include <cstdio>
#include <stdexcept>

#include "drivers/files/dynamics_map_file.hpp"
#include "models/linear_cut.hpp"
#include "models/lobes.hpp"
#include "models/modal_refit.hpp"

namespace stillcut {
namespace {

PredictedPosture predicted_at(const Cell& cell, const CellDynamics& dynamics, const Posture& posture) {
  try {
    return predict_posture(dynamics.map, posture, dynamics.interpolation);
  } catch (const std::invalid_argument& error) {  // the posture was found: what cannot be is in the map or its settings
    throw InputError(require(cell, cell.dynamics, "dynamics").map.string(), 0, error.what());
  }
}

}  // namespace

CellDynamics read_cell_dynamics(const Cell& cell) {
  const DynamicsSettings& dynamics = require(cell, cell.dynamics, "dynamics");
  return {read_dynamics_map(dynamics.map), {.kind = dynamics.interpolation, .power = dynamics.power}};
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
  return predicted_at(cell, dynamics, posture_of(cell, dynamics.map, asked));
}

PredictedPosture stability_posture(const Cell& cell, const CellDynamics& dynamics, const std::string& asked) {
  return stability_posture(cell, dynamics, posture_of(cell, dynamics.map, asked));
}

PredictedPosture stability_posture(const Cell& cell, const CellDynamics& dynamics, const Posture& posture) {
  return with_few_modes(predicted_at(cell, dynamics, posture), kMostFloquetModes);
}

std::vector<std::string> stability_warnings(const Tool& tool, const Cut& cut, const PredictedPosture& predicted) {
  std::vector<std::string> lines = linear_cut_warnings(tool, cut);
  if (predicted.outside) lines.push_back(outside_map_text(predicted) + "; the lobes are an extrapolation");
  if (predicted.fitted_from > 0) {
    std::array<char, 180> line{};
    std::snprintf(
        line.data(), line.size(),
        "interpolation \"frf\" superposes %zu modes; the lobes use %zu fitted ones (receptance off by %.2g %% rms)",
        predicted.fitted_from, predicted.posture.modes.size(), 100.0 * predicted.fit_error);
    lines.emplace_back(line.data());
  }
  return lines;
}

}  // namespace stillcut
