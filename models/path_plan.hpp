// A tool path put together from patches, each with its own feed direction and spindle speed, that is better for the
// dynamics under it than any single direction: what to gain is either the absolute stability index, or the time in
// which the area is cut at a depth that is stable everywhere.
#pragma once

#include <span>
#include <vector>

#include "models/direction_table.hpp"
#include "models/patch_plan.hpp"

namespace stillcut {

enum class PlanObjective { absolute, time };

struct PlanSettings {
  PlanObjective objective = PlanObjective::absolute;
  // What going on to a patch whose direction is turned by a right angle costs, as a share of the whole: of the index,
  // or of the time that the best single direction takes. A smaller turn, or none, costs half of it and of the other
  // half in proportion: a patch has its approach and its edges in any case.
  double turning_cost = 0.02;
  double depth_margin = 0.1;  // how far below the limit the planned depth stays, as a share of the limit
};

struct PlannedPatch {
  double x_begin = 0.0, x_end = 0.0, y_begin = 0.0, y_end = 0.0;  // m; infinite at the area's border
  double direction = 0.0;                                         // rad, in [0, pi)
  double spindle_speed = 0.0;                                     // rad/s
  double depth_limit = 0.0;                                       // m, at that speed
  std::vector<std::size_t> locations{};
};

struct PathPlan {
  std::vector<PlannedPatch> patches;  // in the order of machining
  double axial_depth = 0.0;           // m: below the limit of every patch by the margin
  double cost = 0.0;                  // share of the whole that is lost or taken, changes included
  double single_cost = 0.0;           // the same for the best single direction
};

// `used`: the locations that the area has; the others are not asked. Throws std::invalid_argument where no direction
// allows any depth.
PathPlan plan_path(const DirectionTable& table, std::span<const std::size_t> used, const PlanSettings& settings);

}  // namespace stillcut
