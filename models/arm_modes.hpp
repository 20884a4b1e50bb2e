// An arm about one posture: the small motions of its springs, and the vibration modes that a hammer would find at its
// tool point. With these a robot's description gives a dynamics map, and first lobes, before any tap test.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "models/arm.hpp"
#include "models/dynamics_map.hpp"

namespace stillcut {

// M x'' + C x' + K x = J^T F for the joints' deflections x (rad) under a force F at the tool point (N, base axes).
struct LinearArm {
  JointMatrix mass;       // kg m^2
  JointVector damping;    // N m s/rad, a joint each
  JointMatrix stiffness;  // N m/rad: the springs, and what weight adds or takes as the arm turns
  ToolJacobian jacobian;  // m/rad
};

// A posture (rad) to its linear arm; one for an arm is `linear_arm` bound to it, or SerialArm's.
using Linearise = std::function<LinearArm(const JointVector&)>;

// The arm at `angles`, which gravity compensation holds there exactly.
LinearArm linear_arm(const Arm& arm, const JointVector& angles);

// Receptance at the tool point, J (K + iwC - w^2 M)^-1 J^T: m/N, 3 x 3; frequency in rad/s. Nothing is left out.
Eigen::Matrix3cd arm_receptance(const LinearArm& arm, double frequency);

// A mode, and the joints that make it: `shape` has p^T M p = 1, J p is `reach` m along the mode's direction.
struct ArmMode {
  Mode mode;
  JointVector shape;
  double reach = 0.0;
};

// K p = w^2 M p in rising frequency. At the tool point a mode moves along J p, where its stiffness is w^2/|J p|^2;
// its direction has the largest component positive. Damping is projected, zeta = p^T C p / (2 w): exact where C follows
// M and K, and within (zeta of the modes) x (their overlap) where not; docs/robot.md says how far that is off.
// A mode that moves the tool point, statically, less than a thousandth of what the most compliant does would not be
// found by a hammer and is left out. Throws std::invalid_argument, with the reason, where the arm is no oscillator:
// weight stronger than the springs, a mode damped beyond critical, or a tool point that no joint moves.
std::vector<ArmMode> arm_modes(const LinearArm& arm);

// The same without the joints, as in a dynamics map.
std::vector<Mode> tool_modes(const LinearArm& arm);

// The arm's highest natural frequency, rad/s, whether or not a hammer finds it. Throws as arm_modes.
double highest_frequency(const LinearArm& arm);

}  // namespace stillcut
