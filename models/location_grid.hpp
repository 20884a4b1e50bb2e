// Locations in columns and rows, for dividing an area between them.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

namespace stillcut {

// Locations in columns and rows, and the lines half-way between these. Locations that do not stand in line are gathered
// into at most `most_lines` columns and rows, the narrowest first.
struct LocationGrid {
  std::vector<double> x_lines, y_lines;  // m, rising, between columns and between rows: one less than these
  std::vector<int> column, row;          // of each location
  [[nodiscard]] int columns() const { return static_cast<int>(x_lines.size()) + 1; }
  [[nodiscard]] int rows() const { return static_cast<int>(y_lines.size()) + 1; }
};
LocationGrid location_grid(std::span<const Eigen::Vector2d> places, int most_lines = 10);

}  // namespace stillcut
