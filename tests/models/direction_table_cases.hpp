// Direction tables whose limits are given by a formula, so that what should be chosen is known.
#pragma once

#include <cmath>
#include <functional>

#include "models/direction_table.hpp"

namespace stillcut {

inline constexpr double kLocationSpacing = 0.05;  // m

// A square grid of locations, `spacing` m apart; limit(location's place, direction, speed) in m. Directions in whole
// steps of 180/count degrees.
inline DirectionTable table_of(int columns, int rows, double spacing, int directions, std::vector<double> speeds,
                               const std::function<double(const Eigen::Vector2d&, double, double)>& limit) {
  DirectionTable table;
  table.speeds = std::move(speeds);
  table.max_depth = 0.02;
  for (int d = 0; d < directions; ++d) table.directions.push_back(std::numbers::pi * d / directions);
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      LocationLimits location;
      location.posture = std::to_string(row * columns + column + 1);
      location.place = {column * spacing, row * spacing};
      for (const double direction : table.directions) {
        DirectionCurve curve{direction, {}};
        for (const double speed : table.speeds) curve.limits.push_back(limit(location.place, direction, speed));
        location.curves.push_back(curve);
        for (double& depth : curve.limits) depth *= 0.9;  // up-milling allows a little less
        location.alternating.push_back(curve);
      }
      table.locations.push_back(location);
    }
  }
  return table;
}

// Highest along `best`, less the further the feed turns away from it.
inline double falling_from(double best, double direction, double highest) {
  return highest * (0.5 + 0.5 * std::cos(2.0 * (direction - best)) * 0.8 + 0.1);
}

}  // namespace stillcut
