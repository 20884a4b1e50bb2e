// The machined wall as a stylus would measure it: a slice's contour along a line.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "models/part_slice.hpp"

namespace stillcut {

// Where the stylus goes; m, workpiece axes, `along` and `into` of length 1. It starts in the air at `start` and looks
// for the wall in the direction `into`, up to `reach` away.
struct WallLine {
  Eigen::Vector2d start = Eigen::Vector2d::Zero(), along = Eigen::Vector2d::UnitX(), into = Eigen::Vector2d::UnitY();
  double length = 4e-3;   // ISO 4288: five sampling lengths of 0.8 mm where R_a is 0.1 to 2 um
  double spacing = 1e-6;  // of the points
  double reach = 1e-3;
};

// How far the wall is from the line at each point, m; larger is deeper in the part. Throws std::invalid_argument for a
// line of fewer than three points, std::runtime_error where there is no wall within reach.
std::vector<double> wall_profile(const PartSlice& slice, const WallLine& line);

}  // namespace stillcut
