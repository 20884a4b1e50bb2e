// The region that is machined: what lies within a polygon and outside its islands, workpiece axes. Tool path patterns
// (models/path_patterns) fill it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "models/contour.hpp"

namespace stillcut {

struct Region {
  Contour polygon;               // m, either sense of turning
  std::vector<Contour> islands;  // m, likewise
};

// Where a point lies, as messages have it: "(12.5, 300) mm".
std::string in_mm(const Eigen::Vector2d& point);

// The contour without points that repeat the one before, the last one included where it closes the contour.
Contour without_repeats(const Contour& contour);

// What is wrong with the polygon: fewer than three points, no area, a crossing or touch of itself, a point that is not
// finite or lies farther than 10 m from the origin. One line that says where and what to do; empty: nothing.
std::optional<std::string> polygon_fault(const Contour& polygon);

// The same of the islands, and one that is not inside the polygon, or meets another. The polygon has no fault.
std::optional<std::string> islands_fault(const Region& region);

// The region without repeated points. Throws std::invalid_argument with the fault.
Region checked_region(const Region& region);

}  // namespace stillcut
