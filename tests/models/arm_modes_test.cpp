// The linearised arm: its modes against an independent solver, its receptance, and what projecting the damping costs.
#include "models/arm_modes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include "models/arm_dynamics.hpp"
#include "models/four_axis_arm.hpp"
#include "models/receptance.hpp"
#include "models/serial_arm.hpp"
#include "models/symmetric_eigen.hpp"
#include "tests/models/elastic_joint_robot.hpp"
#include "tests/models/machining_arm.hpp"

namespace stillcut {
namespace {

using std::numbers::pi;

TEST(SymmetricEigen, TakesAMatrixApart) {
  JointMatrix root = JointMatrix::Random(6, 6);
  const JointMatrix matrix = root * root.transpose();
  const SymmetricEigen eigen = symmetric_eigen(matrix);
  EXPECT_LT((eigen.vectors * eigen.values.asDiagonal() * eigen.vectors.transpose() - matrix).norm(),
            1e-14 * matrix.norm());
  EXPECT_LT((eigen.vectors.transpose() * eigen.vectors - JointMatrix::Identity(6, 6)).norm(), 1e-14);
  EXPECT_TRUE(std::is_sorted(eigen.values.begin(), eigen.values.end()));
}

TEST(ArmModes, SolveTheEigenproblemAndRise) {
  for (const Arm& arm : {huynh_robot(), test::machining_arm()}) {
    const LinearArm linear = linear_arm(arm, home_angles(arm));
    const std::vector<ArmMode> modes = arm_modes(linear);
    ASSERT_GE(modes.size(), 4U);
    double before = 0.0;
    for (const ArmMode& mode : modes) {
      const double w = mode.mode.natural_frequency;
      const JointVector elastic = linear.stiffness * mode.shape;
      EXPECT_LT((elastic - w * w * linear.mass * mode.shape).norm(), 1e-11 * elastic.norm());
      EXPECT_NEAR(mode.shape.dot(linear.mass * mode.shape), 1.0, 1e-12);
      const Eigen::Map<const Eigen::Vector3d> direction(mode.mode.direction.data());
      EXPECT_LT((linear.jacobian * mode.shape - mode.reach * direction).norm(), 1e-12);
      EXPECT_GT(w, before);
      before = w;
    }
  }
}

// The robot that the dynamics map's tests shake, with its own equations and Eigen's solver.
TEST(ArmModes, AgreeWithTheRobotOfTheMapsTests) {
  const test::ElasticRobot robot = test::kuka();
  Arm arm;
  arm.gravity = 0.0;
  arm.tool = robot.tool;
  for (const test::RobotLink& link : robot.links) {
    ArmJoint joint;
    joint.origin = link.joint;
    joint.axis = link.axis;
    joint.mass = link.mass;
    joint.centre = link.centre;
    joint.inertia = link.inertia.asDiagonal();
    joint.stiffness = link.stiffness;
    joint.damping = link.damping;
    arm.joints.push_back(joint);
  }
  test::JointAngles angles;
  angles << 0.3, -1.1, 1.4, 0.2, 0.9, -0.4;
  const std::vector<Mode> ours = tool_modes(linear_arm(arm, angles)), theirs = test::modes_at(robot, angles);
  ASSERT_EQ(ours.size(), theirs.size());
  for (std::size_t i = 0; i < ours.size(); ++i) {
    EXPECT_NEAR(ours[i].natural_frequency, theirs[i].natural_frequency, 1e-9 * theirs[i].natural_frequency);
    EXPECT_NEAR(ours[i].stiffness, theirs[i].stiffness, 1e-8 * theirs[i].stiffness);
    EXPECT_NEAR(ours[i].damping_ratio, theirs[i].damping_ratio, 1e-9);
  }
}

TEST(ArmModes, OnePendulumIsThatOfTheTextbook) {
  Arm arm = huynh_robot();
  arm.joints.resize(1);  // one joint, about a level axis, a mass on a light rod straight up
  ArmJoint& joint = arm.joints[0];
  joint.axis = Eigen::Vector3d::UnitY();
  joint.mass = 20.0;
  joint.centre = {0, 0, 0.5};
  joint.inertia.setZero();
  joint.stiffness = 1e4;
  joint.damping = 7.0;
  arm.tool = {0, 0, 0.8};
  const std::vector<Mode> modes = tool_modes(linear_arm(arm, JointVector::Zero(1)));
  ASSERT_EQ(modes.size(), 1U);
  const double inertia = 20.0 * 0.25, stiffness = 1e4 - 20.0 * 9.81 * 0.5;  // its weight topples it
  EXPECT_NEAR(modes[0].natural_frequency, std::sqrt(stiffness / inertia), 1e-9);
  EXPECT_NEAR(modes[0].stiffness, stiffness / 0.64, 1e-8);
  EXPECT_NEAR(modes[0].damping_ratio, 7.0 / (2.0 * std::sqrt(stiffness * inertia)), 1e-12);
  EXPECT_NEAR(modes[0].direction[0], 1.0, 1e-12);
  joint.stiffness = 90.0;
  EXPECT_THROW(tool_modes(linear_arm(arm, JointVector::Zero(1))), std::invalid_argument);  // falls over
}

TEST(ArmModes, KdlGivesTheSameModes) {
  const Arm arm = test::machining_arm();
  SerialArm kdl(arm);
  const std::vector<Mode> ours = tool_modes(linear_arm(arm, home_angles(arm)));
  const std::vector<Mode> theirs = tool_modes(kdl.linearised(home_angles(arm)));
  ASSERT_EQ(ours.size(), theirs.size());
  for (std::size_t i = 0; i < ours.size(); ++i) {
    EXPECT_NEAR(ours[i].natural_frequency, theirs[i].natural_frequency, 1e-9 * ours[i].natural_frequency);
    EXPECT_NEAR(ours[i].stiffness, theirs[i].stiffness, 1e-9 * ours[i].stiffness);
  }
}

TEST(ArmModes, FirstModesOfTheMachiningArmAreARobots) {
  const Arm arm = test::machining_arm();
  const double first = tool_modes(linear_arm(arm, home_angles(arm))).front().natural_frequency / (2 * pi);
  EXPECT_GT(first, 8.0);
  EXPECT_LT(first, 20.0);
}

// Proportional damping is projected exactly, so that the modes are the arm; all modes kept.
TEST(ArmModes, AreTheReceptanceWhereDampingIsProportional) {
  Arm arm = huynh_robot();
  arm.gravity = 0.0;
  for (ArmJoint& joint : arm.joints) joint.damping = 2e-4 * joint.stiffness;
  const LinearArm linear = linear_arm(arm, home_angles(arm));
  const std::vector<Mode> modes = tool_modes(linear);
  ASSERT_EQ(modes.size(), 4U);
  for (double hz = 5.0; hz < 400.0; hz *= 1.1) {
    const Eigen::Matrix3cd whole = arm_receptance(linear, 2 * pi * hz);
    EXPECT_LT((receptance(modes, 2 * pi * hz) - whole).norm(), 1e-10 * whole.norm()) << hz;
  }
}

// Where it is not: at the peaks of the structure's own modes the projection stays within a few per cent.
TEST(ArmModes, ProjectedDampingIsNearAtThePeaks) {
  for (const Arm& arm : {huynh_robot(), test::machining_arm()}) {
    const LinearArm linear = linear_arm(arm, home_angles(arm));
    const std::vector<Mode> modes = tool_modes(linear);
    for (std::size_t i = 0; i < 3; ++i) {
      const Eigen::Matrix3cd whole = arm_receptance(linear, modes[i].natural_frequency);
      const double off = (receptance(modes, modes[i].natural_frequency) - whole).norm() / whole.norm();
      EXPECT_LT(off, 0.03) << i;
      RecordProperty("off_" + arm.name.substr(0, 5) + std::to_string(i), std::to_string(off));
    }
  }
}

TEST(ArmModes, RefusesAnArmThatDoesNotVibrate) {
  Arm arm = huynh_robot();
  for (ArmJoint& joint : arm.joints) joint.damping *= 100.0;
  try {
    tool_modes(linear_arm(arm, home_angles(arm)));
    FAIL() << "not refused";
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("beyond critical"), std::string::npos);
  }
  arm = huynh_robot();
  arm.joints.resize(1);
  arm.tool = {0, 0, 1};  // on the joint's axis
  EXPECT_THROW(tool_modes(linear_arm(arm, JointVector::Zero(1))), std::invalid_argument);
}

}  // namespace
}  // namespace stillcut
