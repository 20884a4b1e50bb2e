// Where on its dynamics map a cell works: the posture that the user named, or the cell file, or the map's only one, and
// the modes predicted there. Every command and the daemon choose it here, by the same steps and with the same messages.
#pragma once

#include <string>
#include <vector>

#include "drivers/files/cell.hpp"
#include "models/interpolation.hpp"

namespace stillcut {

// The cell's map and how to interpolate in it.
struct CellDynamics {
  DynamicsMap map;
  Interpolation interpolation;
};

// Reads [dynamics] and its map. Throws InputError.
CellDynamics read_cell_dynamics(const Cell& cell);

// `asked` is what a user wrote after --posture; empty: the cell file's dynamics.posture, and without that the map's
// only posture. Throws InputError, with what would be right, for a posture that the map does not know or that nobody
// names.
Posture posture_of(const Cell& cell, const DynamicsMap& map, const std::string& asked = {});

// The posture and its modes in workpiece axes. Throws InputError.
PredictedPosture predicted_posture(const Cell& cell, const CellDynamics& dynamics, const std::string& asked = {});

// The same with fitted modes where "frf" superposes more than the Floquet solution takes. Throws InputError.
PredictedPosture stability_posture(const Cell& cell, const CellDynamics& dynamics, const std::string& asked = {});

// The same at a posture that no user named: one moved from the map's. Throws InputError.
PredictedPosture stability_posture(const Cell& cell, const CellDynamics& dynamics, const Posture& posture);

// What a reader of lobes at this posture has to know, one line each: parts of the cell that they leave out, a posture
// outside the map, modes that were fitted. `tool` and `cut` are the cell's.
std::vector<std::string> stability_warnings(const Tool& tool, const Cut& cut, const PredictedPosture& predicted);

}  // namespace stillcut
