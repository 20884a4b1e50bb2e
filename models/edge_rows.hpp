// All points of an edge at once, as the spindle turns: each coordinate is fixed + sine sin(phi) + cosine cos(phi) at
// its tooth's angle phi, so that placing an edge takes no sine of each point.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "models/cutter_motion.hpp"
#include "models/swept_patches.hpp"

namespace stillcut {

struct EdgeAxis {
  std::vector<double> fixed, sine, cosine;
};
using EdgeRows = std::array<EdgeAxis, 3>;  // x and y in points of a map, z in m

// The points of an edge of this tool as it is inclined, from the tool's position on its path, for a map of these
// spacings.
[[nodiscard]] EdgeRows edge_rows(const CutterMotion& motion, std::span<const EdgePoint> points, double spacing_along,
                                 double spacing_across);

// Places the points [row.begin, row.end) at an angle, each coordinate moved by `beside` (points, points, m).
void place_row(const EdgeRows& rows, double sine, double cosine, const Eigen::Vector3d& beside, EdgeRow& row);

}  // namespace stillcut
