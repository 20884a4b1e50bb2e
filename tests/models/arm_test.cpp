// Descriptions of arms, their equations of motion, and the inverse kinematics.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <stdexcept>
#include <string>

#include "models/arm_dynamics.hpp"
#include "models/arm_reach.hpp"
#include "models/feed_path.hpp"
#include "models/four_axis_arm.hpp"
#include "models/serial_arm.hpp"
#include "tests/models/machining_arm.hpp"

namespace stillcut {
namespace {

JointVector random_joints(int n, double largest, std::mt19937& random) {
  std::uniform_real_distribution<> uniform(-largest, largest);
  JointVector joints(n);
  for (double& joint : joints) joint = uniform(random);
  return joints;
}

template <class Call>
std::string refusal_of(Call&& call) {
  try {
    call();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(ArmDynamics, DAlembertAgreesWithKdl) {
  std::mt19937 random{7};
  for (const Arm& arm : {huynh_robot(), test::machining_arm()}) {
    SerialArm kdl(arm);
    for (int i = 0; i < 100; ++i) {
      const JointVector q = random_joints(arm.size(), 3.0, random), v = random_joints(arm.size(), 3.0, random);
      const ArmPose pose = arm_pose(arm, q);
      const EquationsOfMotion ours = equations_of_motion(arm, pose, v), theirs = kdl.equations(q, v);
      EXPECT_LT((ours.mass - theirs.mass).norm(), 1e-9 * theirs.mass.norm());
      EXPECT_LT((ours.coriolis - theirs.coriolis).norm(), 1e-9 * theirs.coriolis.norm());
      EXPECT_LT((ours.gravity - theirs.gravity).norm(), 1e-9 * theirs.gravity.norm());
      EXPECT_LT((pose.tool - kdl.tool(q)).norm(), 1e-9);
      EXPECT_LT((tool_jacobian(arm, pose) - kdl.jacobian(q)).norm(), 1e-9);
    }
  }
}

TEST(ArmDynamics, MomentaAndTheirSlopesBelongToTheSameEquations) {
  std::mt19937 random{8};
  constexpr double kDelta = 1e-5;
  for (const Arm& arm : {huynh_robot(), test::machining_arm()}) {
    for (int i = 0; i < 20; ++i) {
      const JointVector q = random_joints(arm.size(), 3.0, random), a = random_joints(arm.size(), 2.0, random),
                        b = random_joints(arm.size(), 2.0, random);
      const ArmPose pose = arm_pose(arm, q);
      const EquationsOfMotion equations = equations_of_motion(arm, pose, a);
      EXPECT_LT((momenta(arm, pose, a) - equations.mass * a).norm(), 1e-12 * equations.mass.norm());
      EXPECT_LT((gravity_torques(arm, pose) - equations.gravity).norm(), 1e-12 * equations.gravity.norm());
      JointVector slope(arm.size()), weight(arm.size());
      JointMatrix stiffness(arm.size(), arm.size());
      for (int k = 0; k < arm.size(); ++k) {
        JointVector before = q, after = q;
        before[k] -= kDelta;
        after[k] += kDelta;
        const ArmPose first = arm_pose(arm, before), second = arm_pose(arm, after);
        slope[k] = a.dot(momenta(arm, second, b) - momenta(arm, first, b)) / (4.0 * kDelta);
        weight[k] = (gravity_energy(arm, second) - gravity_energy(arm, first)) / (2.0 * kDelta);
        stiffness.col(k) = (gravity_torques(arm, second) - gravity_torques(arm, first)) / (2.0 * kDelta);
      }
      EXPECT_LT((kinetic_slope(arm, pose, a, b) - slope).norm(), 1e-7 * (1.0 + slope.norm()));
      EXPECT_LT((equations.gravity - weight).norm(), 1e-7 * equations.gravity.norm());
      EXPECT_LT((gravity_stiffness(arm, pose) - stiffness).norm(), 1e-7 * stiffness.norm());
      // Lagrange: d/dt (M v) less the slope of the kinetic energy is what the gyroscopic terms are.
      const JointVector rate =
          (momenta(arm, arm_pose(arm, q + kDelta * a), a) - momenta(arm, arm_pose(arm, q - kDelta * a), a)) /
          (2.0 * kDelta);
      EXPECT_LT((rate - kinetic_slope(arm, pose, a, a) - equations.coriolis).norm(), 1e-6 * equations.coriolis.norm());
    }
  }
}

TEST(ArmDynamics, ToolMovesAsTheJacobianSays) {
  std::mt19937 random{9};
  constexpr double kDelta = 1e-5;
  const Arm arm = test::machining_arm();
  const JointVector q = random_joints(6, 2.0, random), v = random_joints(6, 2.0, random);
  const ArmPose pose = arm_pose(arm, q), before = arm_pose(arm, q - kDelta * v), after = arm_pose(arm, q + kDelta * v);
  EXPECT_LT((tool_velocity(arm, pose, v) - (after.tool - before.tool) / (2.0 * kDelta)).norm(), 1e-8);
  EXPECT_LT((tool_velocity(arm, pose, v) - tool_jacobian(arm, pose) * v).norm(), 1e-13);
  EXPECT_LT((tool_convective_acceleration(arm, pose, v) -
             (tool_velocity(arm, after, v) - tool_velocity(arm, before, v)) / (2.0 * kDelta))
                .norm(),
            1e-7);
  const Eigen::Vector3d force{3.0, -4.0, 5.0};
  EXPECT_LT((tool_torques(arm, pose, force) - tool_jacobian(arm, pose).transpose() * force).norm(), 1e-12);
}

TEST(FourAxisArm, HasTheFiguresOfThePaper) {
  const Arm arm = huynh_robot();
  EXPECT_NO_THROW(check_arm(arm));
  double mass = 183.0;  // the base, which does not move
  for (const ArmJoint& joint : arm.joints) mass += joint.mass;
  EXPECT_DOUBLE_EQ(mass, 981.0);
  EXPECT_LT((arm_pose(arm, JointVector::Zero(4)).tool - Eigen::Vector3d(0, 0, 2.65)).norm(), 1e-15);
  for (std::size_t i = 0; i < 4; ++i)  // eq. 9 with D_ref and K_ref of joint 1
    EXPECT_NEAR(arm.joints[i].damping, 1057.2 * std::sqrt(arm.joints[i].stiffness / 3.8e6), 0.5) << i;
}

TEST(FourAxisArm, TwoTrianglesFindTheAngles) {
  const Arm arm = huynh_robot();
  for (const Eigen::Vector3d& place : {Eigen::Vector3d{1.1, 0, 0}, {0.9, -0.8, 0.4}, {-0.5, 1.2, 0.7}}) {
    const JointVector angles = four_axis_angles({}, place);
    const ArmPose pose = arm_pose(arm, angles);
    EXPECT_LT((pose.tool - place).norm(), 1e-14);
    EXPECT_LT((pose.turned[3].col(2) - Eigen::Vector3d(0, 0, -1)).norm(), 1e-14);
    EXPECT_GT(pose.joint[2].z(), 0.5 * (pose.joint[1].z() + pose.joint[3].z()));  // elbow up
    EXPECT_LT((arm_pose(arm, reach(arm, place)).tool - place).norm(), 1e-9);
  }
}

TEST(FourAxisArm, RefusesPlacesWithTheReason) {
  const auto refusal = [](double x, double y, double z) {
    return refusal_of([&] { four_axis_angles({}, {x, y, z}); });
  };
  EXPECT_EQ(refusal(2.5, 0, 0), "the tool cannot be at 2500.0,0.0,0.0 mm: the arm does not reach so far");
  EXPECT_NE(refusal(0.05, 0, 0.45).find("so near to its shoulder"), std::string::npos);
  EXPECT_NE(refusal(1.7995, 0, 0.45).find("singular there, stretched"), std::string::npos);
  EXPECT_NE(refusal(0.1001, 0, 0.45).find("singular there, folded"), std::string::npos);
  EXPECT_NE(refusal(0.0, 0.001, -0.5).find("axis of joint 1"), std::string::npos);
  EXPECT_NE(refusal(std::nan(""), 0, 0).find("not finite"), std::string::npos);
}

TEST(ArmReach, FindsPlacesWithTheToolTurnedAsAtHome) {
  const Arm arm = test::machining_arm();
  const ArmPose home = arm_pose(arm, home_angles(arm));
  for (const Eigen::Vector3d& shift : {Eigen::Vector3d{0.2, 0.3, -0.1}, {-0.3, -0.4, 0.2}, {0.0, 0.0, 0.0}}) {
    const ArmPose pose = arm_pose(arm, reach(arm, home.tool + shift));
    EXPECT_LT((pose.tool - home.tool - shift).norm(), 1e-9);
    EXPECT_LT((pose.turned[5] - home.turned[5]).norm(), 1e-8);
  }
}

// Fails with a step that aims at the place alone, with the turn about the wrong axes, or one turned back the wrong way.
TEST(ArmReach, FindsPosesFromANearbyPosture) {
  const Arm arm = test::machining_arm();
  std::mt19937 random(20240611);
  std::uniform_real_distribution<double> share(-1.0, 1.0);
  int reached = 0;
  for (int trial = 0; trial < 500; ++trial) {
    JointVector there(arm.size()), start(arm.size());
    for (int i = 0; i < arm.size(); ++i) {
      there[i] = home_angles(arm)[i] + 0.5 * share(random);
      start[i] = there[i] + 0.3 * share(random);
    }
    const ToolPose asked = tool_pose(arm, there);
    JointVector found;
    try {
      found = reach(arm, asked, start);
    } catch (const std::invalid_argument&) {  // on the way to a singular posture
      continue;
    }
    ++reached;
    const ToolPose pose = tool_pose(arm, found);
    EXPECT_LT((pose.place - asked.place).norm(), 1e-9) << trial;
    EXPECT_LT((pose.turned - asked.turned).norm(), 2e-9) << trial;
    EXPECT_EQ(beyond_limits(arm, found), "") << trial;
  }
  EXPECT_GE(reached, 495);
}

TEST(ArmReach, TurnsAJointBackWhereItsLimitsAsk) {
  Arm arm = test::machining_arm();
  const JointVector home = home_angles(arm);
  JointVector round = home;
  round[5] += 2.0 * std::numbers::pi;
  arm.joints[5].upper = 7.0;
  EXPECT_LT((reach(arm, tool_pose(arm, home), round) - round).norm(), 1e-9);
  arm.joints[5].upper = 3.1;
  EXPECT_LT((reach(arm, tool_pose(arm, home), round) - home).norm(), 1e-9);
}

TEST(ArmReach, RefusesATurnThatTheArmCannotMake) {
  Arm arm = test::machining_arm();
  const JointVector home = home_angles(arm);
  ToolPose asked = tool_pose(arm, home);
  asked.turned = Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitZ()) * asked.turned;
  EXPECT_NO_THROW(reach(arm, asked, home));
  arm.joints[5].lower = -0.1;
  arm.joints[5].upper = 0.1;
  EXPECT_NE(refusal_of([&] { reach(arm, asked, home); }).find("joint_6 at"), std::string::npos);
}

TEST(ArmReach, RefusesPlacesWithTheReason) {
  Arm arm = test::machining_arm();
  const auto refusal = [&](const Eigen::Vector3d& place) { return refusal_of([&] { reach(arm, place); }); };
  EXPECT_NE(refusal({6.0, 0, 1}).find("does not reach there; the nearest it came is"), std::string::npos);
  const Eigen::Vector3d home = arm_pose(arm, home_angles(arm)).tool;
  arm.joints[0].lower = -0.1;
  arm.joints[0].upper = 0.1;
  EXPECT_NE(refusal(home + Eigen::Vector3d(-0.2, 0.6, 0)).find("beyond its limits, -5.7 to 5.7 deg"),
            std::string::npos);
  arm = test::machining_arm();
  arm.joints[4].home = 0.0;  // the wrist's axes in one line: the tool cannot be turned every way
  EXPECT_NE(refusal(arm_pose(arm, home_angles(arm)).tool).find("singular"), std::string::npos);
}

TEST(CheckArm, NamesTheJointAndWhatIsWrong) {
  const auto refusal = [](auto&& change) {
    Arm arm = huynh_robot();
    change(arm);
    return refusal_of([&] { check_arm(arm); });
  };
  EXPECT_EQ(refusal([](Arm&) {}), "");
  EXPECT_NE(refusal([](Arm& arm) { arm.joints.clear(); }).find("no joint"), std::string::npos);
  EXPECT_NE(refusal([](Arm& arm) { arm.joints.resize(9, arm.joints[0]); }).find("up to 8"), std::string::npos);
  EXPECT_EQ(refusal([](Arm& arm) { arm.joints[1].stiffness = 0; }), "joint joint_2: its stiffness must be above 0");
  EXPECT_NE(refusal([](Arm& arm) { arm.joints[2].damping = -1; }).find("damping"), std::string::npos);
  EXPECT_NE(refusal([](Arm& arm) { arm.joints[2].axis *= 2; }).find("unit vector"), std::string::npos);
  EXPECT_NE(refusal([](Arm& arm) { arm.joints[2].inertia(0, 0) = 20; }).find("no body has"), std::string::npos);
  EXPECT_NE(refusal([](Arm& arm) { arm.joints[3].home = 9, arm.joints[3].upper = 3; }).find("home"), std::string::npos);
  EXPECT_NE(refusal([](Arm& arm) {
              arm.joints[3].mass = 0;
              arm.joints[3].inertia.setZero();
            }).find("moves no mass"),
            std::string::npos);
}

TEST(FeedPath, TakesUpTheFeedInASecond) {
  const FeedPath path{{1, 2, 3}, Eigen::Vector3d::UnitY(), 3.7 / 60.0};
  EXPECT_EQ(feed_state(path, -1.0).speed, 0.0);
  EXPECT_NEAR(feed_state(path, 0.4).acceleration, path.feed_rate / 0.6, 1e-15);
  EXPECT_NEAR(feed_state(path, 0.6).acceleration, path.feed_rate / 0.6, 1e-15);
  EXPECT_NEAR(feed_state(path, 0.5).speed, path.feed_rate / 2, 1e-15);
  EXPECT_NEAR(feed_state(path, 1.0).speed, path.feed_rate, 1e-15);
  EXPECT_NEAR(feed_state(path, 1.0).acceleration, 0.0, 1e-15);
  EXPECT_NEAR(feed_state(path, 1.0).travel, path.feed_rate / 2, 1e-15);  // the profile is even about its middle
  EXPECT_NEAR(feed_position(path, 3.0).y(), 2.0 + 2.5 * path.feed_rate, 1e-14);
  for (double t = 0.05; t < 1.3; t += 0.05) {
    const double d = 1e-5;
    const FeedState before = feed_state(path, t - d), at = feed_state(path, t), after = feed_state(path, t + d);
    EXPECT_NEAR((after.travel - before.travel) / (2 * d), at.speed, 1e-9);
    EXPECT_NEAR((after.speed - before.speed) / (2 * d), at.acceleration, 2e-6);
  }
  EXPECT_THROW(feed_state({.jerk_time = 0.0}, 1.0), std::invalid_argument);
}

}  // namespace
}  // namespace stillcut
