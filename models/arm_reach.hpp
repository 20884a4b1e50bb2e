// Inverse kinematics of any serial arm: the joint angles that bring the tool to a place, turned as asked.
#pragma once

#include <Eigen/Core>

#include "models/arm.hpp"

namespace stillcut {

// Where the tool is and how it is turned.
struct ToolPose {
  Eigen::Vector3d place = Eigen::Vector3d::Zero();       // m, of the tool point, base axes
  Eigen::Matrix3d turned = Eigen::Matrix3d::Identity();  // from the last link's axes to the base's
};

// `angles`: one a joint, rad.
ToolPose tool_pose(const Arm& arm, const JointVector& angles);

// Newton steps from `start` until the tool point is at the place to 1e-9 m, the tool turned as asked: to 1e-9 rad with
// six joints or more, as nearly as fewer allow. Of a joint's angles a whole turn apart the one nearest to `start` that
// its limits allow. Throws std::invalid_argument, with the reason, where the arm does not reach, a joint would be
// beyond its limits, or the arm is singular there: it can move the tool some way (or turn it, with six joints) less
// than 1/200 as easily as another, taking 1 m for 1 rad.
JointVector reach(const Arm& arm, const ToolPose& pose, const JointVector& start);

// The same for a place (m, base axes) from the home posture, the tool turned as at home.
JointVector reach(const Arm& arm, const Eigen::Vector3d& place);

}  // namespace stillcut
