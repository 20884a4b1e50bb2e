// Where every point of a ball-end cutter's edges is as it follows a tool path: straight moves of the tool's tip between
// which the axis turns evenly, each with its feed and spindle speed. Time and spindle angle go on along the whole path.
//
// Workpiece axes. A tool path gives the tip (where the axis leaves the ball); the ball's centre is R up the axis. About
// its axis the tool stands as tilt and lead put it (eq. 5 with the feed along workpiece +X); that only matters for the
// phase of the teeth.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "models/cutter_motion.hpp"
#include "models/tool_path.hpp"

namespace stillcut {

// What a path may leave open.
struct PathConditions {
  double feed_rate = 0.0;           // m/s, of feed moves whose path does not say; 0: such a path is refused
  double spindle_speed = 0.0;       // rad/s, likewise
  double rapid_rate = 10.0 / 60.0;  // m/s
  double angle = 0.0, time = 0.0;   // rad and s where the path begins
};

// A move with the time and the spindle angle of its beginning.
struct PathPiece {
  Eigen::Vector3d from, to;            // m, the tip
  Eigen::Vector3d axis_from, axis_to;  // unit, from the tip to the holder
  double axis_turn = 0.0;              // rad between them
  double time = 0.0, duration = 0.0;   // s
  double angle = 0.0;                  // rad, of tooth 0
  double spindle_speed = 0.0;          // rad/s
  bool feeds = false;                  // with feed and a turning spindle: edges leave a surface
  bool cuts = false;                   // as the path has it: across the axis
  int line = 0;                        // of the file
};

struct CutterPath {
  Tool tool;
  std::vector<PathPiece> pieces;
  std::vector<double> tooth_angle;   // rad, of the tip behind tooth 0
  std::vector<double> axial_offset;  // m, up the axis
  Displacement displacement;         // workpiece axes
  double fastest_radian = 0.0;       // m the ball's centre travels while the spindle turns by a radian, at most
};

// Throws std::invalid_argument, in words for the user and with the file's line: a tool that is no ball, feeds or
// spindle speeds that nobody says, an axis on or below the horizon, a path that never feeds.
[[nodiscard]] CutterPath cutter_path(const Tool& tool, const ToolPath& path, const PathConditions& conditions = {},
                                     Displacement displacement = {});

struct BallPose {
  Eigen::Vector3d centre;       // m, of the ball
  Eigen::Matrix3d orientation;  // tool to workpiece axes
};

// `elapsed` s after the piece began.
[[nodiscard]] BallPose ball_pose(const CutterPath& path, const PathPiece& piece, double elapsed);

// A point of an edge (eqs 10 and 27), m, as edge_position() of a pass has it.
[[nodiscard]] Eigen::Vector3d edge_position(const CutterPath& path, const PathPiece& piece, std::size_t tooth,
                                            const EdgePoint& point, double elapsed);

// How far runout and vibration take an edge from where it should be, at most, m.
[[nodiscard]] double farthest_beside(const CutterPath& path);

// A fifth of the smallest feed per tooth of the moves that cut, m: what coarsest_spacing() asks of a cut, but for the
// step-over, which a path does not tell.
[[nodiscard]] double coarsest_spacing(const CutterPath& path);

}  // namespace stillcut
