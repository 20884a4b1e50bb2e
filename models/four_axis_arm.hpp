// The multibody paper's robot (Huynh et al. 2017): a six-axis Staubli TX200 reduced to four axes, of which the last
// keeps the spindle upright. Its description and its inverse kinematics.
#pragma once

#include <Eigen/Core>

#include "models/arm.hpp"

namespace stillcut {

// Lengths of the moving links, m: shoulder (from the base upward), main arm, forearm, spindle.
struct FourAxisLengths {
  double shoulder = 0.65, main_arm = 0.95, forearm = 0.85, spindle = 0.2;
};

// Masses, inertias and lengths of Table 1, joint stiffness and damping of Table 2, frames of eqs 1 to 5: joint 1 turns
// about z, joints 2 to 4 about y, and with all angles 0 the arm stands straight up. The tool point is the spindle's
// end. Home is 1.1 m in front of joint 1 at the height of its foot, spindle down.
Arm huynh_robot();

// Joint angles (rad) that bring the tool point to `place` (m, base axes) with the spindle pointing straight down, elbow
// up: one triangle in the plane from above, one of main arm, forearm and the line from shoulder to wrist. Throws
// std::invalid_argument, with the reason, where the arm does not reach, or is singular: stretched or folded within
// 0.1 % of the limit, or the tool on the axis of joint 1, where a small path asks for a large turn.
JointVector four_axis_angles(const FourAxisLengths& lengths, const Eigen::Vector3d& place);

}  // namespace stillcut
