// Inverse kinematics of any serial arm: the joint angles that bring the tool point to a place.
#pragma once

#include <Eigen/Core>

#include "models/arm.hpp"

namespace stillcut {

// Newton steps from the home posture until the tool point is at `place` (m, base axes) to 1e-9 m, the tool turned as at
// home: exactly with six joints or more, as nearly as fewer allow. Throws std::invalid_argument, with the reason, where
// the arm does not reach, a joint would be beyond its limits, or the arm is singular there: it can move the tool some
// way (or turn it, with six joints) less than 1/200 as easily as another, taking 1 m for 1 rad.
JointVector reach(const Arm& arm, const Eigen::Vector3d& place);

}  // namespace stillcut
