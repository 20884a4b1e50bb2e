// The plan of a path made into the path: each patch filled with lines in its own direction, its spindle speed on every
// move; and layers of it down to a depth.
#pragma once

#include "models/path_patterns.hpp"
#include "models/path_plan.hpp"
#include "models/pattern_rating.hpp"
#include "models/tool_path.hpp"

namespace stillcut {

// Zig lines patch after patch, in the plan's order; a patch is where the tool's centre is between the patch's borders.
// Moves carry the patch's spindle speed and the feed rate for it. Throws std::invalid_argument as make_pattern does.
ToolPath planned_path(const Region& region, const PathPlan& plan, const PatternSettings& settings,
                      const CuttingConditions& conditions);

// The same path at one spindle speed (rad/s) throughout.
ToolPath with_speed(ToolPath path, double spindle_speed, const CuttingConditions& conditions);

// The path again and again, each layer lower, until `depth` (m) below its own z = 0 is cut in equal layers of at most
// `layer`. Between them the tool rises to `clearance` (m) above the top. Throws std::invalid_argument for depths that
// are not positive or more than 10000 layers.
ToolPath in_layers(const ToolPath& path, double depth, double layer, double clearance);

}  // namespace stillcut
