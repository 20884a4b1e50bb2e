#include "tools/posture_variations.hpp"

#include <Eigen/Geometry>
#include <charconv>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include "drivers/files/csv.hpp"
#include "drivers/files/robot_file.hpp"
#include "models/arm_reach.hpp"
#include "models/machining.hpp"

namespace stillcut {
namespace {

constexpr int kRedundantJoints = 6;
constexpr double kSameTool = 1e-3;  // m: what maps are rounded to, and more
constexpr int kMostValues = 10'000;

template <class Number>
Number parsed_number(const std::string& text) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) throw std::invalid_argument("no number");
  return value;
}

// The workpiece's Z, tilted as the cell says at its own feed direction (Liu et al. 2024, eq. 5).
Eigen::Vector3d tool_axis(const Cut& cut) {
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), y = Eigen::Vector3d::UnitY(), z = Eigen::Vector3d::UnitZ();
  return Eigen::AngleAxisd(cut.feed_direction, z) * Eigen::AngleAxisd(cut.tilt, x) * Eigen::AngleAxisd(cut.lead, y) * z;
}

JointVector joints_of(const Arm& arm, const Posture& posture) {
  JointVector angles(arm.size());
  for (int i = 0; i < arm.size(); ++i) angles[i] = posture.joints[static_cast<std::size_t>(i)];
  return angles;
}

}  // namespace

std::vector<double> equally_spaced_values(const std::string& text) {
  std::vector<std::string> parts;
  std::istringstream in(text);
  for (std::string part; std::getline(in, part, ':');) parts.push_back(part);
  double low = 0.0, high = 0.0;
  int count = 0;
  try {
    if (parts.size() != 3) throw std::invalid_argument("not three");
    low = parsed_number<double>(parts[0]);
    high = parsed_number<double>(parts[1]);
    count = parsed_number<int>(parts[2]);
  } catch (const std::invalid_argument&) {
    throw std::invalid_argument("'" + text + "' is not MIN:MAX:COUNT, such as -30:30:13");
  }
  if (!std::isfinite(low) || !std::isfinite(high) || count < 1 || count > kMostValues ||
      (count == 1 ? low != high : !(low < high))) {
    throw std::invalid_argument("'" + text +
                                "': MIN must be below MAX and COUNT 2 to 10000, or MIN be MAX and COUNT 1");
  }
  std::vector<double> values;
  for (int i = 0; i < count; ++i) {
    const double value = count == 1 ? low : low + (high - low) * i / (count - 1);
    values.push_back(std::round(value * 1e9) / 1e9 + 0.0);  // a middle meant to be 0 is 0, and not -0
  }
  return values;
}

std::vector<Variation> all_variations(const VariationsAsked& asked) {
  const std::vector<double> none{0.0};
  std::vector<Variation> variations;
  for (const double y : asked.ys.value_or(none)) {
    for (const double x : asked.xs.value_or(none)) {
      for (const double redundancy : asked.redundancies.value_or(none)) variations.push_back({redundancy, x, y});
    }
  }
  return variations;
}

PostureMover::PostureMover(const Cell& cell, const DynamicsMap& map, const VariationsAsked& asked)
    : robot_file_{asked.robot}, tool_axis_{tool_axis(require(cell, cell.cut, "cut"))} {
  if (!asked.any()) return;
  const std::string map_file = require(cell, cell.dynamics, "dynamics").map.string();
  if (!map.has_joints && asked.redundancies)
    throw InputError(map_file, 0,
                     "the map has no joints, so it cannot tell the redundancy angle; ask --placement only");
  if (!map.has_joints && !asked.robot.empty())
    throw InputError(map_file, 0, "the map has no joints, so a robot tells nothing about it; leave --robot out");
  if (!map.has_joints) return;
  if (asked.robot.empty()) {
    throw InputError(map_file, 0,
                     "the map is by joint angles; give --robot FILE.urdf, the robot that turns and moves by them");
  }
  arm_ = read_robot(asked.robot);
  const std::string joints = "the arm has " + std::to_string(arm_->size()) + " joints; ";
  if (arm_->size() > kRedundantJoints) throw InputError(asked.robot, 0, joints + "a dynamics map holds six");
  if (arm_->size() < kRedundantJoints && asked.redundancies)
    throw InputError(asked.robot, 0, joints + "to turn about the tool's axis takes six; ask --placement only");
}

Posture PostureMover::moved(const Posture& posture, const Variation& variation) const {
  Posture result = posture;
  if (variation == Variation{}) return result;
  if (!arm_) {
    result.position[0] += variation.x;
    result.position[1] += variation.y;
    return result;
  }
  const JointVector start = joints_of(*arm_, posture);
  ToolPose pose = tool_pose(*arm_, start);
  pose.place += Eigen::Vector3d(variation.x, variation.y, 0.0);
  pose.turned = Eigen::AngleAxisd(variation.redundancy, tool_axis_) * pose.turned;
  const JointVector angles = reach(*arm_, pose, start);
  for (int i = 0; i < arm_->size(); ++i) result.joints[static_cast<std::size_t>(i)] = angles[i];
  result.position = {pose.place.x(), pose.place.y(), pose.place.z()};
  return result;
}

std::string PostureMover::disagreement(const DynamicsMap& map) const {
  if (!arm_) return {};
  double farthest = kSameTool;
  std::string id;
  for (const Posture& posture : map.postures) {
    const Eigen::Vector3d place(posture.position[0], posture.position[1], posture.position[2]);
    const double away = (tool_pose(*arm_, joints_of(*arm_, posture)).place - place).norm();
    if (away > farthest) farthest = away, id = posture.id;
  }
  if (id.empty()) return {};
  return robot_file_ + ": its tool is " + csv_number(std::round(farthest * 1e4) / 10.0) +
         " mm from where the map says at " + id +
         "; check that it is this robot with this tool, and its base the workpiece frame";
}

}  // namespace stillcut
