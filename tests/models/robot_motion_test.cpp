// Robots in time: against other rules and the equations themselves, along a path, and what stops them.
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "models/arm_dynamics.hpp"
#include "models/arm_modes.hpp"
#include "models/feed_path.hpp"
#include "models/linearised_robot.hpp"
#include "tests/models/moving_robots.hpp"

namespace stillcut {
namespace {

using test::kNothing;
using test::kRobotStep;
using test::kTap;

TEST(NewmarkRobot, PredictsWhereItWillBeAndSaysHowItMoves) {
  const Arm arm = test::machining_arm();
  NewmarkRobot robot(arm, holding(home_angles(arm)), kRobotStep);
  robot.strike(kTap);
  Eigen::Vector3d force = kNothing, before, velocity;
  for (int i = 0; i < 500; ++i) {
    const Eigen::Vector3d next = 200.0 * std::sin(0.02 * i) * kTap;
    const Eigen::Vector3d predicted = robot.displacement_after(force, next);
    before = robot.displacement();
    velocity = robot.velocity();
    robot.advance(force, next);
    ASSERT_LT((predicted - robot.displacement()).norm(), 1e-9 * robot.displacement().norm() + 1e-15);
    force = next;
  }
  EXPECT_LT(((robot.displacement() - before) / kRobotStep - 0.5 * (velocity + robot.velocity())).norm(), 1e-6);
  const Eigen::Vector3d now = robot.velocity(), accelerated = robot.acceleration();
  robot.advance(force, force);
  EXPECT_LT(((robot.velocity() - now) / kRobotStep - 0.5 * (accelerated + robot.acceleration())).norm(),
            1e-3 * accelerated.norm());
}

// Where the mass matrix does not change the rule is Newmark's own (1/4, 1/2).
TEST(NewmarkRobot, IsNewmarksRuleWhereTheMassIsConstant) {
  Arm arm = huynh_robot();
  arm.joints.resize(1);
  arm.tool = {0.5, 0.0, 0.3};
  const double mass = linear_arm(arm, JointVector::Zero(1)).mass(0, 0), damping = arm.joints[0].damping,
               stiffness = arm.joints[0].stiffness, h = 1e-3;
  NewmarkRobot robot(arm, holding(JointVector::Zero(1)), h);
  robot.strike({0, 2.0, 0});
  double x = 0.0, v = 2.0 * 0.5 / mass, a = -damping * v / mass;
  for (int i = 0; i < 200; ++i) {
    const double predicted = x + h * v + h * h / 4.0 * a, speed = v + h / 2.0 * a;
    a = -(damping * speed + stiffness * predicted) / (mass + h / 2.0 * damping + h * h / 4.0 * stiffness);
    x = predicted + h * h / 4.0 * a;
    v = speed + h / 2.0 * a;
    robot.advance(kNothing, kNothing);
    ASSERT_NEAR(robot.angles()[0], x, 1e-11 * 2e-3) << i;
  }
}

// Large swings of a soft arm, where everything is nonlinear, against Runge and Kutta's rule on d'Alembert's equations.
void expect_same_swing(Arm soft) {
  for (ArmJoint& joint : soft.joints) {
    joint.stiffness = 3e4;
    joint.damping *= 0.1;
  }
  const JointVector home = home_angles(soft);
  const JointVector held = gravity_torques(soft, arm_pose(soft, home));
  const double h = 2e-4;
  NewmarkRobot robot(soft, holding(home), h / 2.0);  // second order against fourth
  robot.strike(100.0 * kTap);
  const auto accelerations = [&](const JointVector& q, const JointVector& v) {
    const EquationsOfMotion equations = equations_of_motion(soft, arm_pose(soft, q), v);
    JointVector torque = held - equations.gravity - equations.coriolis;
    for (int i = 0; i < soft.size(); ++i) {
      const ArmJoint& joint = soft.joints[static_cast<std::size_t>(i)];
      torque[i] -= joint.stiffness * (q[i] - home[i]) + joint.damping * v[i];
    }
    return JointVector(equations.mass.llt().solve(torque));
  };
  JointVector q = home, v = robot.velocities();
  double largest = 0.0;
  for (int i = 0; i < 500; ++i) {
    const JointVector a1 = accelerations(q, v), v2 = v + h / 2 * a1, a2 = accelerations(q + h / 2 * v, v2),
                      v3 = v + h / 2 * a2, a3 = accelerations(q + h / 2 * v2, v3), v4 = v + h * a3,
                      a4 = accelerations(q + h * v3, v4);
    q += h / 6 * (v + 2 * v2 + 2 * v3 + v4);
    v += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
    for (int half = 0; half < 2; ++half) robot.advance(kNothing, kNothing);
    largest = std::max(largest, (q - home).cwiseAbs().maxCoeff());
  }
  EXPECT_GT(largest, 0.05);
  EXPECT_LT((robot.angles() - q).norm(), 1e-4 * largest);
  EXPECT_LT((robot.velocities() - v).norm(), 1e-3 * v.norm());
}

TEST(NewmarkRobot, SwingsAsDAlembertsEquationsSay) {
  expect_same_swing(huynh_robot());
  expect_same_swing(test::machining_arm());
}

// The tool follows the paper's feed profile; on the move the joints' dampers drag it behind by D q'/K.
TEST(NewmarkRobot, FollowsTheFeedPathOfThePaper) {
  const Arm arm = huynh_robot();
  const FeedPath path{{1.1, 0.0, 0.0}, Eigen::Vector3d::UnitX(), 3.7 / 60.0};
  const JointPath command = [&](double time) { return four_axis_angles({}, feed_position(path, time)); };
  NewmarkRobot robot(arm, command, 1e-3);
  double largest = 0.0;
  for (int i = 0; i < 1500; ++i) {
    robot.advance(kNothing, kNothing);
    largest = std::max(largest, robot.displacement().norm());
  }
  EXPECT_LT(largest, 60e-6);
  const JointVector rate = (command(1.5) - command(1.499)) / 1e-3;
  JointVector lag(4);
  for (int i = 0; i < 4; ++i)
    lag[i] =
        -arm.joints[static_cast<std::size_t>(i)].damping * rate[i] / arm.joints[static_cast<std::size_t>(i)].stiffness;
  const ArmPose pose = arm_pose(arm, command(1.5));
  EXPECT_LT((robot.displacement() - tool_velocity(arm, pose, lag)).norm(), 2e-6);
  Arm relative = arm;
  relative.damps_joint_velocity = false;
  NewmarkRobot other(relative, command, 1e-3);
  for (int i = 0; i < 1500; ++i) other.advance(kNothing, kNothing);
  EXPECT_LT(other.displacement().norm(), 2e-6);
}

TEST(LinearisedRobot, TakesItsMotionAlongAsThePostureMoves) {
  const Arm arm = huynh_robot();
  const FeedPath path{{1.1, 0.0, 0.0}, Eigen::Vector3d::UnitY(), 0.3};
  const JointPath command = [&](double time) { return four_axis_angles({}, feed_position(path, time + 1.0)); };
  const auto linearise = [&](const JointVector& q) { return linear_arm(arm, q); };
  LinearisedRobot robot(linearise, command, kRobotStep, 1e-3), coarse(linearise, command, kRobotStep, 1e-2);
  robot.strike(kTap);
  coarse.strike(kTap);
  const double energy = robot.energy();
  double largest = 0.0, apart = 0.0, highest = 0.0;
  for (int i = 0; i < 5000; ++i) {
    robot.advance(kNothing, kNothing);
    coarse.advance(kNothing, kNothing);
    largest = std::max(largest, robot.displacement().norm());
    apart = std::max(apart, (robot.displacement() - coarse.displacement()).norm());
    highest = std::max(highest, robot.energy());
  }
  EXPECT_GT(robot.linearisations(), 20);
  EXPECT_LT(apart, 0.05 * largest);
  EXPECT_LT(highest, 1.001 * energy);  // nothing is gained on the way
}

template <class Call>
std::string why_stopped(Call&& call) {
  try {
    call();
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST(Robots, StopWithTheTimeAndTheReason) {
  const Arm arm = test::machining_arm();
  const JointPath home = holding(home_angles(arm));
  const auto linearise = [&](const JointVector& q) { return linear_arm(arm, q); };
  for (const std::string& reason : {why_stopped([&] { NewmarkRobot(arm, home, 0.01); }),
                                    why_stopped([&] { LinearisedRobot(linearise, home, 0.01); })}) {
    EXPECT_EQ(reason.find("at 0 s: the step of 10 ms is too large: the arm's"), 0U) << reason;
  }
  const Eigen::Vector3d huge(1e7, 0, 0);
  NewmarkRobot robot(arm, home, kRobotStep);
  LinearisedRobot fast(linearise, home, kRobotStep);
  for (const std::string& reason : {why_stopped([&] {
                                      while (true) robot.advance(huge, huge);
                                    }),
                                    why_stopped([&] {
                                      while (true) fast.advance(huge, huge);
                                    })}) {
    EXPECT_EQ(reason.find("at 0.0"), 0U) << reason;
    EXPECT_NE(reason.find("the motion diverges"), std::string::npos) << reason;
  }
  EXPECT_TRUE(robot.displacement().allFinite());
  const FeedPath away{{1.7, 0.0, 0.0}, Eigen::Vector3d::UnitX(), 1.0};
  const JointPath path = [&](double time) { return four_axis_angles({}, feed_position(away, time)); };
  const Arm four = huynh_robot();
  NewmarkRobot leaving(four, path, 1e-3);
  LinearisedRobot leaving_fast([&](const JointVector& q) { return linear_arm(four, q); }, path, 1e-3);
  for (const std::string& reason : {why_stopped([&] {
                                      while (true) leaving.advance(kNothing, kNothing);
                                    }),
                                    why_stopped([&] {
                                      while (true) leaving_fast.advance(kNothing, kNothing);
                                    })}) {
    EXPECT_EQ(reason.find("at 0."), 0U) << reason;
    EXPECT_NE(reason.find("the arm is singular there, stretched"), std::string::npos) << reason;
  }
  const Eigen::Vector3d nothing_known(NAN, 0, 0);
  EXPECT_NE(why_stopped([&] { robot.advance(kNothing, nothing_known); }), "");
  EXPECT_TRUE(robot.displacement().allFinite());
  EXPECT_THROW(NewmarkRobot(arm, home, 0.0), std::invalid_argument);
  EXPECT_THROW(NewmarkRobot(arm, holding(JointVector::Zero(3)), kRobotStep), std::invalid_argument);
}

// A force that grows with the tool's own motion, faster than dampers take it away, as in a chatter that nothing stops.
TEST(Robots, UnstableCutEndsInAReasonNotInInfinities) {
  const Arm arm = huynh_robot();
  NewmarkRobot robot(arm, holding(home_angles(arm)), kRobotStep);
  robot.strike(kTap);
  const std::string reason = why_stopped([&] {
    for (int i = 0; i < 400000; ++i) {
      const Eigen::Vector3d force = 3e5 * robot.velocity();
      robot.advance(force, force);
    }
  });
  EXPECT_NE(reason.find("leaves its command by more than 0.2 rad"), std::string::npos) << reason;
  EXPECT_TRUE(robot.displacement().allFinite());
}

}  // namespace
}  // namespace stillcut
