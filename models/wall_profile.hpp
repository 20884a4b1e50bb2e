// The machined wall as a stylus would measure it: a slice's contour along a line, and the figures of its roughness.
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

// Of a profile less its least-squares line, in the profile's own unit: arithmetic and quadratic mean (ISO 4287), total
// height. `mean` and `slope` (a point's rise over the distance `spacing` gives) are the line's, at the middle.
struct Roughness {
  double ra = 0.0, rq = 0.0, rt = 0.0;
  double mean = 0.0, slope = 0.0;
};

// Throws std::invalid_argument for fewer than three points or a spacing that is not positive.
Roughness roughness(std::span<const double> heights, double spacing);

}  // namespace stillcut
