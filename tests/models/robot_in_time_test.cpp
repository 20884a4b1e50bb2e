// Robots in time: energy, receptance from a tap, order of accuracy.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <string>
#include <vector>

#include "models/arm_modes.hpp"
#include "models/linearised_robot.hpp"
#include "models/newmark_robot.hpp"
#include "models/receptance.hpp"
#include "tests/models/moving_robots.hpp"
#include "tests/sanitized.hpp"

namespace stillcut {
namespace {

using std::numbers::pi;

using test::kNothing;
using test::kRobotStep;
using test::kTap;

Arm undamped(Arm arm) {
  for (ArmJoint& joint : arm.joints) joint.damping = 0.0;
  return arm;
}

class EveryRobot : public ::testing::TestWithParam<bool> {
 protected:
  [[nodiscard]] static Arm arm() { return GetParam() ? test::machining_arm() : huynh_robot(); }
};
INSTANTIATE_TEST_SUITE_P(Robots, EveryRobot, ::testing::Bool(),
                         [](const auto& robot) { return robot.param ? "SixJoints" : "FourAxes"; });

// Gravity acts and is compensated; largest excursion of the energy at any step.
TEST_P(EveryRobot, KeepsItsEnergyForTenSecondsAfterATap) {
  const Arm free = undamped(arm());
  NewmarkRobot robot(free, holding(home_angles(free)), kRobotStep);
  robot.strike(kTap);
  const double energy = robot.energy();
  EXPECT_GT(energy, 1e-3);
  double worst = 0.0;
  const int steps = static_cast<int>((test::kSanitized ? 0.3 : 10.0) / kRobotStep);
  for (int i = 0; i < steps; ++i) {
    robot.advance(kNothing, kNothing);
    worst = std::max(worst, std::abs(robot.energy() / energy - 1.0));
  }
  EXPECT_LT(worst, 1e-6);
  RecordProperty("energy_off", std::to_string(1e12 * worst) + "e-12");
}

TEST_P(EveryRobot, WorkOfTheForceIsItsEnergy) {
  const Arm free = undamped(arm());
  NewmarkRobot robot(free, holding(home_angles(free)), kRobotStep);
  double work = 0.0;
  Eigen::Vector3d force = kNothing;
  for (int i = 0; i < 2000; ++i) {
    const Eigen::Vector3d next =
        300.0 * std::sin(2.0 * pi * 20.0 * (i + 1) * kRobotStep) * Eigen::Vector3d(1, 0.4, -0.3);
    const Eigen::Vector3d before = robot.displacement();
    robot.advance(force, next);
    work += 0.5 * (force + next).dot(robot.displacement() - before);
    force = next;
  }
  EXPECT_NEAR(robot.energy(), work, 1e-6 * std::abs(work));
}

// The frequency response that a hammer test would compute: the transform of the tool's free motion after a unit
// impulse, by the trapezoidal rule, with the tail that has not decayed left out as it is below 1e-5.
template <class Robot>
Eigen::Vector3cd tapped(Robot& robot, const Eigen::Vector3d& tap, const std::vector<double>& frequencies,
                        double seconds, std::vector<Eigen::Vector3cd>& response) {
  robot.strike(tap);
  response.assign(frequencies.size(), Eigen::Vector3cd::Zero());
  std::vector<std::complex<double>> turn, phase(frequencies.size(), 1.0);
  for (const double w : frequencies) turn.push_back(std::polar(1.0, -w * kRobotStep));
  for (int i = 0; i < static_cast<int>(seconds / kRobotStep); ++i) {
    const Eigen::Vector3d x = robot.displacement() * ((i == 0 ? 0.5 : 1.0) * kRobotStep);
    for (std::size_t k = 0; k < frequencies.size(); ++k) {
      response[k] += phase[k] * x;
      phase[k] *= turn[k];
    }
    robot.advance(kNothing, kNothing);
  }
  return response.front();
}

// Peaks and their flanks, two half bandwidths to either side.
std::vector<double> around(const std::vector<Mode>& modes) {
  std::vector<double> frequencies;
  for (const Mode& mode : modes) {
    for (const double shift : {-2.0, -1.0, 0.0, 1.0, 2.0})
      frequencies.push_back(mode.natural_frequency * (1.0 + shift * std::min(mode.damping_ratio, 0.1)));
  }
  return frequencies;
}

TEST_P(EveryRobot, TapReturnsTheReceptance) {
  const Arm whole = arm();
  const LinearArm linear = linear_arm(whole, home_angles(whole));
  const std::vector<Mode> modes = tool_modes(linear);
  const std::vector<double> frequencies = around(modes);
  const double seconds = test::kSanitized ? 1.0 : 6.0;
  for (int axis = 0; axis < (test::kSanitized ? 1 : 3); ++axis) {
    const Eigen::Vector3d tap = Eigen::Vector3d::Unit(axis);
    std::vector<Eigen::Vector3cd> found;
    NewmarkRobot newmark(whole, holding(home_angles(whole)), kRobotStep);
    tapped(newmark, tap, frequencies, seconds, found);
    double worst = 0.0;
    for (std::size_t k = 0; k < frequencies.size(); ++k) {
      const Eigen::Matrix3cd exact = arm_receptance(linear, frequencies[k]);
      worst = std::max(worst, (found[k] - exact.col(axis)).norm() / exact.norm());
    }
    EXPECT_LT(worst, test::kSanitized ? 0.2 : 0.01) << "whole robot, axis " << axis;
    RecordProperty("whole_" + std::to_string(axis), std::to_string(worst));

    LinearisedRobot fast([&](const JointVector& q) { return linear_arm(whole, q); }, holding(home_angles(whole)),
                         kRobotStep);
    tapped(fast, tap, frequencies, seconds, found);
    worst = 0.0;
    for (std::size_t k = 0; k < frequencies.size(); ++k) {
      const Eigen::Matrix3cd exact = receptance(modes, frequencies[k]);
      worst = std::max(worst, (found[k] - exact.col(axis)).norm() / exact.norm());
    }
    EXPECT_LT(worst, test::kSanitized ? 0.2 : 0.01) << "modes, axis " << axis;
    RecordProperty("modes_" + std::to_string(axis), std::to_string(worst));
  }
}

TEST_P(EveryRobot, StandsStillUnderItsOwnWeight) {
  const Arm heavy = arm();
  NewmarkRobot robot(heavy, holding(home_angles(heavy)), kRobotStep);
  for (int i = 0; i < 1000; ++i) robot.advance(kNothing, kNothing);
  EXPECT_LT(robot.displacement().norm(), 1e-14);
  EXPECT_LT(robot.acceleration().norm(), 1e-10);
}

TEST_P(EveryRobot, HalfTheStepIsAQuarterOfTheError) {
  const Arm damped = arm();
  const auto end = [&](int steps) {
    NewmarkRobot robot(damped, holding(home_angles(damped)), 0.02 / steps);
    robot.strike(20.0 * kTap);
    for (int i = 0; i < steps; ++i) robot.advance(kNothing, kNothing);
    return robot.displacement();
  };
  const Eigen::Vector3d fine = end(6400);
  EXPECT_NEAR((end(200) - fine).norm() / (end(400) - fine).norm(), 4.0, 0.15);
}

}  // namespace
}  // namespace stillcut
