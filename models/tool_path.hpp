// A tool path in workpiece axes: straight moves of the tool's tip, one after the other, each beginning where the one
// before it ended. Arcs are broken into moves by whoever makes a path. Patterns (models/path_patterns) and files of
// G-code and APT cutter locations (drivers/files) give the same value.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "models/milling_kind.hpp"

namespace stillcut {

struct PathMove {
  Eigen::Vector3d from = Eigen::Vector3d::Zero(), to = Eigen::Vector3d::Zero();  // m, workpiece
  Eigen::Vector3d tool_axis = Eigen::Vector3d::UnitZ();                          // unit, from the tip to the holder
  bool cutting = true;                                                           // false: rapid, through the air
  std::optional<Milling> milling{};  // which side meets the part; empty: the path does not say
  double feed_rate = std::numeric_limits<double>::quiet_NaN();      // m/s; NaN: not said
  double spindle_speed = std::numeric_limits<double>::quiet_NaN();  // rad/s; NaN: not said
  int line = 0;                                                     // of the file; 0: from no file
  // The axis where the move begins, from which it turns evenly to `tool_axis`; empty: as the move before ended.
  std::optional<Eigen::Vector3d> axis_from{};
};

struct ToolPath {
  std::string name;
  std::vector<PathMove> moves;
};

}  // namespace stillcut
