// The limits over direction at the locations of a machining area, computed on several threads.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "models/direction_table.hpp"
#include "models/path_locations.hpp"
#include "models/region.hpp"
#include "tools/cell_posture.hpp"

namespace stillcut {

// The modes at the named postures, or at every one of the map in its order; or, with `grid` (m), at places so far apart
// (at most) over the box around the postures, which a map without joint angles can tell between them. Throws
// InputError.
std::vector<PredictedPosture> study_locations(const Cell& cell, const CellDynamics& dynamics,
                                              const std::vector<std::string>& postures, std::optional<double> grid);

// What a location is asked for beside the table's own directions.
struct LocationQuestion {
  std::vector<double> directions;              // rad, milling as set
  std::vector<double> alternating_directions;  // rad
};

// Fills the locations of a table whose directions, speeds and depth are given. One question a location. Throws
// InputError where the lobes cannot be computed.
void solve_table(const Cell& cell, const Cut& cut, DirectionMethod method,
                 const std::vector<PredictedPosture>& locations, const std::vector<LocationQuestion>& questions,
                 int threads, const std::function<void(double)>& progress, DirectionTable& table);

}  // namespace stillcut
