// Both robots at the rate of the sensors, and a tap, for tests of robots in time.
#pragma once

#include <Eigen/Core>

#include "models/four_axis_arm.hpp"
#include "models/newmark_robot.hpp"
#include "tests/models/machining_arm.hpp"

namespace stillcut::test {

inline constexpr double kRobotStep = 1.0 / 25600.0;  // s
inline const Eigen::Vector3d kNothing = Eigen::Vector3d::Zero();
inline const Eigen::Vector3d kTap{0.6, 0.5, -0.6244997998398398};  // 1 N s, along no axis

}  // namespace stillcut::test
