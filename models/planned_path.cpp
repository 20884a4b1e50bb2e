#include "models/planned_path.hpp"

#include <cmath>
#include <stdexcept>

namespace stillcut {
namespace {

void set_speed(PathMove& move, double spindle_speed, const CuttingConditions& conditions) {
  move.spindle_speed = spindle_speed;
  constexpr double kPlungeShare = 0.3;  // of the feed: the middle of an end mill cuts badly
  const bool plunge = !move.cutting && move.to.z() < move.from.z();
  if (move.cutting) move.feed_rate = feed_rate_at(conditions, spindle_speed);
  if (plunge) move.feed_rate = kPlungeShare * feed_rate_at(conditions, spindle_speed);
}

// Through the air from where a path is to where the next one begins, both above the part.
void join(ToolPath& path, const ToolPath& next) {
  if (next.moves.empty()) return;
  if (!path.moves.empty() && path.moves.back().to != next.moves.front().from) {
    PathMove across;
    across.from = path.moves.back().to;
    across.to = next.moves.front().from;
    across.cutting = false;
    across.spindle_speed = next.moves.front().spindle_speed;  // changed in the air, not on the plunge
    path.moves.push_back(across);
  }
  path.moves.insert(path.moves.end(), next.moves.begin(), next.moves.end());
}

}  // namespace

ToolPath with_speed(ToolPath path, double spindle_speed, const CuttingConditions& conditions) {
  for (PathMove& move : path.moves) set_speed(move, spindle_speed, conditions);
  return path;
}

ToolPath planned_path(const Region& region, const PathPlan& plan, const PatternSettings& settings,
                      const CuttingConditions& conditions) {
  ToolPath path;
  path.name = "optimized";
  for (const PlannedPatch& patch : plan.patches) {
    PatternSettings within = settings;
    within.window = PatternWindow{patch.x_begin, patch.x_end, patch.y_begin, patch.y_end};
    const ToolPath lines = make_pattern(region, PatternKind::zig, patch.direction, within);
    join(path, with_speed(lines, patch.spindle_speed, conditions));
  }
  return path;
}

ToolPath in_layers(const ToolPath& path, double depth, double layer, double clearance) {
  constexpr double kMostLayers = 10000.0;
  if (!(depth > 0.0 && layer > 0.0 && depth / layer <= kMostLayers))
    throw std::invalid_argument("layers: depth and layer above 0, at most 10000 layers");
  const int count = static_cast<int>(std::ceil(depth / layer - 1e-9));
  ToolPath result;
  result.name = path.name;
  for (int i = 1; i <= count; ++i) {
    ToolPath lower = path;
    const double z = -depth * i / count;
    for (PathMove& move : lower.moves) {
      // What is above the part stays above all of it; what cuts is lowered.
      move.from.z() = move.from.z() > 0.0 ? clearance : z + move.from.z();
      move.to.z() = move.to.z() > 0.0 ? clearance : z + move.to.z();
    }
    join(result, lower);
  }
  return result;
}

}  // namespace stillcut
