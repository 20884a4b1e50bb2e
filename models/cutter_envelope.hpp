// What the body that a turning cutter fills leaves of the surface between its passes, and how high above the surface
// edges still count. The body of a ball end is a sphere, however the tool is inclined; of an end mill its bottom disc.
#pragma once

#include "models/cutter_motion.hpp"

namespace stillcut {

// Height of the ridge between two passes, m: R - sqrt(R^2 - (a_e/2)^2) of a ball. Throws std::invalid_argument for a
// step-over wider than the tool.
[[nodiscard]] double scallop_height(const CutterMotion& motion, double step_over);

// Edges above `highest` need not be swept: some tooth, runout and vibration included, cuts deeper there.
struct SweptHeights {
  double highest = 0.0;                              // m over the surface
  double reach = 0.0;                                // m from the tool's position to where an edge is as low, at most
  Eigen::Vector3d beside = Eigen::Vector3d::Zero();  // m, how far runout and vibration take an edge in each map axis
};

// Throws std::invalid_argument, in words for the user, where the step-over is wider than the tool, where its ridges are
// higher than the depth of cut, and where a ball does not touch the surface with its ball alone.
[[nodiscard]] SweptHeights swept_heights(const CutterMotion& motion, const Cut& cut);

}  // namespace stillcut
