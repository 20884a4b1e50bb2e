#include "models/cutter_path.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <stdexcept>
#include <string>

namespace stillcut {
namespace {

constexpr double kLowestAxis = 1e-3;  // of the axis along z: a ball's lower side must face the table

[[noreturn]] void refuse_move(const PathMove& move, const std::string& message) {
  throw std::invalid_argument("tool path" + (move.line > 0 ? ", line " + std::to_string(move.line) : "") + ": " +
                              message);
}

void check_axis(const PathMove& move, const Eigen::Vector3d& axis) {
  if (!(std::abs(axis.norm() - 1.0) < 1e-6)) refuse_move(move, "the tool's axis must be a unit vector");
  if (axis.z() > kLowestAxis) return;
  char text[160];
  (void)std::snprintf(text, sizeof text,
                      "the tool's axis leans %.1f degrees from the vertical, to the horizon or below; heights over "
                      "workpiece X and Y need it above",
                      rad_to_deg(std::acos(std::clamp(axis.z(), -1.0, 1.0))));
  refuse_move(move, text);
}

double angle_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

Eigen::Vector3d axis_at(const PathPiece& piece, double share) {
  if (piece.axis_turn < 1e-12) return piece.axis_to;
  const double whole = std::sin(piece.axis_turn);
  return (std::sin((1.0 - share) * piece.axis_turn) * piece.axis_from +
          std::sin(share * piece.axis_turn) * piece.axis_to) /
         whole;
}

// R_x(tilt) R_y(lead) of eq. 5 for the tilt and lead that give this axis.
Eigen::Matrix3d orientation_of(const Eigen::Vector3d& axis) {
  const double sin_lead = axis.x(), cos_lead = std::hypot(axis.y(), axis.z());
  const double sin_tilt = -axis.y() / cos_lead, cos_tilt = axis.z() / cos_lead;
  Eigen::Matrix3d result;
  result << cos_lead, 0.0, sin_lead,                        //
      sin_tilt * sin_lead, cos_tilt, -sin_tilt * cos_lead,  //
      -cos_tilt * sin_lead, sin_tilt, cos_tilt * cos_lead;
  return result;
}

PathPiece piece_of(const PathMove& move, const Eigen::Vector3d& axis_from, const PathConditions& conditions) {
  check_axis(move, axis_from);
  check_axis(move, move.tool_axis);
  PathPiece piece{.from = move.from, .to = move.to, .axis_from = axis_from, .axis_to = move.tool_axis};
  piece.line = move.line;
  piece.cuts = move.cutting;
  piece.axis_turn = angle_between(axis_from, move.tool_axis);
  piece.spindle_speed = std::isnan(move.spindle_speed) ? conditions.spindle_speed : move.spindle_speed;
  double feed_rate = move.feed_rate;
  if (std::isnan(feed_rate) && move.cutting) feed_rate = conditions.feed_rate;
  if (move.cutting && !(feed_rate > 0.0)) refuse_move(move, "its feed is not known; give one");
  if (move.cutting && !(piece.spindle_speed > 0.0)) refuse_move(move, "its spindle speed is not known; give one");
  piece.feeds = feed_rate > 0.0 && piece.spindle_speed > 0.0;
  piece.duration = (move.to - move.from).norm() / (feed_rate > 0.0 ? feed_rate : conditions.rapid_rate);
  return piece;
}

}  // namespace

CutterPath cutter_path(const Tool& tool, const ToolPath& path, const PathConditions& conditions,
                       Displacement displacement) {
  check_teeth(tool);
  if (tool.shape != ToolShape::ball)
    throw std::invalid_argument(
        "tool path: the surface along a path is known for ball ends only; set shape = \"ball\"");
  if (!(conditions.rapid_rate > 0.0)) throw std::invalid_argument("rapid rate: must be positive");
  CutterPath result{.tool = tool,
                    .pieces = {},
                    .tooth_angle = tooth_angles(tool),
                    .axial_offset = axial_offsets(tool),
                    .displacement = std::move(displacement)};
  result.pieces.reserve(path.moves.size());
  double time = conditions.time, angle = conditions.angle;
  Eigen::Vector3d axis = path.moves.empty() ? Eigen::Vector3d::UnitZ() : path.moves.front().tool_axis;
  for (const PathMove& move : path.moves) {
    PathPiece piece = piece_of(move, move.axis_from.value_or(axis), conditions);
    axis = move.tool_axis;
    if (!(piece.duration > 0.0)) continue;
    piece.time = time;
    piece.angle = angle;
    time += piece.duration;
    angle += piece.duration * piece.spindle_speed;
    if (piece.feeds) {
      const double way = (piece.to - piece.from).norm() + 0.5 * tool.diameter * piece.axis_turn;
      result.fastest_radian = std::max(result.fastest_radian, way / (piece.duration * piece.spindle_speed));
    }
    result.pieces.push_back(piece);
  }
  if (!(result.fastest_radian > 0.0)) throw std::invalid_argument("tool path: it never feeds, so nothing is cut");
  return result;
}

BallPose ball_pose(const CutterPath& path, const PathPiece& piece, double elapsed) {
  const double share = elapsed / piece.duration;
  const Eigen::Vector3d axis = axis_at(piece, share);
  return {piece.from + share * (piece.to - piece.from) + 0.5 * path.tool.diameter * axis, orientation_of(axis)};
}

Eigen::Vector3d edge_position(const CutterPath& path, const PathPiece& piece, std::size_t tooth, const EdgePoint& point,
                              double elapsed) {
  const BallPose pose = ball_pose(path, piece, elapsed);
  const double spindle = piece.angle + piece.spindle_speed * elapsed;
  const double phi = spindle + path.tooth_angle[tooth] - point.lag;
  const Eigen::Vector3d in_spindle =
      Eigen::Vector3d(point.radius * std::sin(phi), point.radius * std::cos(phi), point.height) +
      runout_offset(path.tool, spindle, path.axial_offset[tooth]);
  Eigen::Vector3d at = pose.centre + pose.orientation * in_spindle;
  if (path.displacement.at) at += path.displacement.at(piece.time + elapsed);
  return at;
}

double farthest_beside(const CutterPath& path) {
  return std::hypot(path.tool.runout, path.tool.axial_runout) + path.displacement.reach.norm();
}

double coarsest_spacing(const CutterPath& path) {
  double smallest = std::numeric_limits<double>::infinity();
  for (const PathPiece& piece : path.pieces)
    if (piece.cuts)
      smallest = std::min(
          smallest, (piece.to - piece.from).norm() / (piece.duration * piece.spindle_speed) * kTwoPi / path.tool.teeth);
  return 0.2 * smallest;
}

}  // namespace stillcut
