// Tool paths whose surface is swept.
#pragma once

#include <vector>

#include "models/path_surface.hpp"
#include "tests/models/swept_cuts.hpp"

namespace stillcut::test {

inline constexpr double kPathFeed = 4e-3, kPathSpindle = 100.0 * kTwoPi;  // 0.02 mm a tooth of two

inline Tool ball(double diameter = 8e-3) {
  return {.shape = ToolShape::ball, .diameter = diameter, .teeth = 2, .pitch = {kTwoPi / 2, kTwoPi / 2}};
}

// Adds feed moves through points, a rapid before them if the tool is elsewhere.
inline void add_row(ToolPath& path, const std::vector<Eigen::Vector3d>& tips,
                    const std::vector<Eigen::Vector3d>& axes) {
  const auto add = [&](const Eigen::Vector3d& from, std::size_t i, bool cutting) {
    PathMove move{.from = from, .to = tips[i], .tool_axis = axes[i], .cutting = cutting};
    move.spindle_speed = kPathSpindle;
    if (cutting) move.feed_rate = kPathFeed;
    move.line = static_cast<int>(path.moves.size()) + 1;
    path.moves.push_back(move);
  };
  if (!path.moves.empty() && path.moves.back().to != tips[0]) add(path.moves.back().to, 0, false);
  for (std::size_t i = 1; i < tips.size(); ++i) {
    add(tips[i - 1], i, true);
    path.moves.back().axis_from = axes[i - 1];
  }
}

inline ToolPath straight_path(const std::vector<Eigen::Vector3d>& tips) {
  ToolPath path;
  add_row(path, tips, std::vector<Eigen::Vector3d>(tips.size(), Eigen::Vector3d::UnitZ()));
  for (PathMove& move : path.moves) move.axis_from.reset();
  return path;
}

// Parallel passes as a path: from one to the next by rapids that take no time.
inline CutterPath path_of(const SweptCut& cut, const CutterMotion& motion, const std::vector<CutterPass>& passes) {
  const double radius = 0.5 * cut.tool.diameter;
  const Eigen::Vector3d axis = motion.orientation.col(2);
  ToolPath path;
  for (const CutterPass& pass : passes) {
    const Eigen::Vector3d from = Eigen::Vector3d(pass.begin, pass.across, radius) - radius * axis;
    const Eigen::Vector3d to = from + (pass.reversed ? -1.0 : 1.0) * pass.length * Eigen::Vector3d::UnitX();
    add_row(path, {from, to}, {axis, axis});
  }
  for (PathMove& move : path.moves) {
    move.spindle_speed = motion.spindle_speed;
    if (move.cutting) move.feed_rate = motion.feed_rate;
  }
  return cutter_path(cut.tool, path, {.rapid_rate = 1e9, .angle = passes[0].angle, .time = passes[0].time},
                     cut.displacement);
}

inline HeightMap swept(const CutterPath& path, const PathWindow& window, double spacing) {
  return path_surface(path, window, {.spacing = spacing, .allow_coarse = true}).map;
}

}  // namespace stillcut::test
