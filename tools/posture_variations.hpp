// One task, many postures: six joints for a five-axis task leave the turn about the tool's axis free, the redundancy
// angle (Liu et al. 2024, section 2.2), and the part may lie elsewhere before the robot. Here a posture of the map is
// turned and moved so, for its modes to be interpolated where the robot then stands.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "drivers/files/cell.hpp"
#include "models/arm.hpp"
#include "models/dynamics_map.hpp"

namespace stillcut {

// From how the map's posture stands. The workpiece axes, and with them feed directions and modes, keep theirs.
struct Variation {
  double redundancy = 0.0;  // rad, the robot turned about the tool's axis, right-handed, the axis away from the part
  double x = 0.0, y = 0.0;  // m, the part moved in the robot's base axes
  bool operator==(const Variation&) const = default;
};

struct VariationsAsked {
  std::optional<std::vector<double>> redundancies;  // rad
  std::optional<std::vector<double>> xs, ys;        // m, both or none
  std::string robot;                                // URDF file; empty: none
  [[nodiscard]] bool any() const { return redundancies || xs; }
};

// "MIN:MAX:COUNT": so many values equally spaced, both ends included; one value where MIN is MAX. Throws
// std::invalid_argument with what would be right.
std::vector<double> equally_spaced_values(const std::string& text);

// Every combination, placements along X first, each with every redundancy angle; nothing asked: the posture as it is.
std::vector<Variation> all_variations(const VariationsAsked& asked);

// Moves postures of a map; holds the robot where the map has joints.
class PostureMover {
 public:
  // Throws InputError where the map or the robot cannot tell what is asked: a redundancy angle and no joints in the map
  // or fewer than six in the arm; joints and no robot file, or one without joints; an arm of more than six joints.
  PostureMover(const Cell& cell, const DynamicsMap& map, const VariationsAsked& asked);

  // Joints (or, without, the place) after the variation; no variation returns the posture itself. Throws
  // std::invalid_argument, with the reason, where the arm cannot stand so (models/arm_reach).
  [[nodiscard]] Posture moved(const Posture& posture, const Variation& variation) const;

  // A line where the robot file's tool is elsewhere than the map says at one of its postures: another robot, or tool,
  // or base frame. Empty: they agree.
  [[nodiscard]] std::string disagreement(const DynamicsMap& map) const;

 private:
  std::optional<Arm> arm_;
  std::string robot_file_;
  Eigen::Vector3d tool_axis_;
};

}  // namespace stillcut
