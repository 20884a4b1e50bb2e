// The picture of planned moves: position, velocity, acceleration and jerk over time, one colour a move.
#pragma once

#include <vector>

#include "rt/axis_trajectory.hpp"
#include "tools/plot.hpp"

namespace stillcut {

struct DrawnMove {
  AxisTrajectory trajectory;
  std::string label;
};

plot::Figure trajectory_figure(const std::vector<DrawnMove>& moves, const std::string& subtitle);

}  // namespace stillcut
