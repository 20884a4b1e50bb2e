#include "models/arm_reach.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <string>

#include "models/arm_dynamics.hpp"
#include "models/symmetric_eigen.hpp"

namespace stillcut {
namespace {

constexpr int kMostReachSteps = 300;
constexpr double kLargestReachStep = 0.2;  // rad
constexpr double kAtPlace = 1e-9;          // m
constexpr double kTurnedSo = 1e-9;         // rad
constexpr double kStands = 1e-9;           // rad, a step that changes nothing any more
constexpr double kPlaceDamping = 1e-6;     // squared, m^2: keeps a step finite where the arm is singular
constexpr double kTurnDamping = 1e-4;      // squared, rad^2: turns that the joints hardly give are not forced
constexpr double kSingularRatio = 1.0 / 200.0;

using JointColumns = Eigen::Matrix<double, Eigen::Dynamic, 3, 0, kMostJoints, 3>;

JointColumns damped_inverse(const ToolJacobian& jacobian, double damping) {
  const Eigen::Matrix3d square = jacobian * jacobian.transpose() + damping * Eigen::Matrix3d::Identity();
  return jacobian.transpose() * square.inverse();
}

// Smallest over largest singular value: 0 where the arm is singular.
double dexterity(const Arm& arm, const ArmPose& pose) {
  const int rows = arm.size() >= 6 ? 6 : 3;
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 6, kMostJoints> jacobian(rows, arm.size());
  jacobian.topRows(3) = tool_jacobian(arm, pose);
  if (rows == 6) jacobian.bottomRows(3) = turning_jacobian(arm, pose);
  const SymmetricEigen eigen = symmetric_eigen(jacobian * jacobian.transpose());
  return std::sqrt(std::max(0.0, eigen.values[0]) / eigen.values[rows - 1]);
}

[[noreturn]] void refuse_reach(const Eigen::Vector3d& place, const std::string& reason) {
  std::array<char, 120> text{};
  std::snprintf(text.data(), text.size(), "the tool cannot be at %.1f,%.1f,%.1f mm: ", 1e3 * place.x(), 1e3 * place.y(),
                1e3 * place.z());
  throw std::invalid_argument(text.data() + reason);
}

// Newton steps may take a joint round; a whole turn back it stands as well.
JointVector unwound(const Arm& arm, JointVector angles, const JointVector& start) {
  for (int i = 0; i < arm.size(); ++i) {
    const ArmJoint& joint = arm.joints[static_cast<std::size_t>(i)];
    angles[i] = start[i] + std::remainder(angles[i] - start[i], 2.0 * M_PI);
    if (angles[i] > joint.upper && angles[i] - 2.0 * M_PI >= joint.lower) angles[i] -= 2.0 * M_PI;
    if (angles[i] < joint.lower && angles[i] + 2.0 * M_PI <= joint.upper) angles[i] += 2.0 * M_PI;
  }
  return angles;
}

}  // namespace

ToolPose tool_pose(const Arm& arm, const JointVector& angles) {
  const ArmPose pose = arm_pose(arm, angles);
  return {pose.tool, pose.turned[static_cast<std::size_t>(arm.size() - 1)]};
}

JointVector reach(const Arm& arm, const ToolPose& asked, const JointVector& start) {
  if (!asked.place.allFinite() || !asked.turned.allFinite())
    throw std::invalid_argument("the tool's place is not finite");
  JointVector angles = start;
  const int n = arm.size();
  const auto last = static_cast<std::size_t>(n - 1);
  double nearest = INFINITY;
  for (int step = 0; step < kMostReachSteps; ++step) {
    const ArmPose pose = arm_pose(arm, angles);
    const Eigen::Vector3d miss = asked.place - pose.tool;
    const Eigen::AngleAxisd off(Eigen::Matrix3d(asked.turned * pose.turned[last].transpose()));
    nearest = std::min(nearest, miss.norm());
    // The place first; the turning with what the joints can do besides.
    const ToolJacobian moving = tool_jacobian(arm, pose), turning = turning_jacobian(arm, pose);
    const JointColumns inverse =
        damped_inverse(moving, miss.norm() > kLargestReachStep ? kPlaceDamping : 0.01 * kPlaceDamping);
    JointVector change = inverse * miss;
    const JointMatrix besides = JointMatrix::Identity(n, n) - inverse * moving;
    const ToolJacobian turning_besides = turning * besides;
    const Eigen::Vector3d turn = off.angle() * off.axis() - turning * change;
    change += besides * (damped_inverse(turning_besides, kTurnDamping) * turn);
    const double largest = change.cwiseAbs().maxCoeff();
    if (miss.norm() <= kAtPlace && largest <= kStands) {
      if (dexterity(arm, pose) < kSingularRatio) refuse_reach(asked.place, "the arm is singular there");
      if (n < 6 || off.angle() <= kTurnedSo) {
        angles = unwound(arm, angles, start);
        const std::string beyond = beyond_limits(arm, angles);
        if (!beyond.empty()) refuse_reach(asked.place, beyond);
        return angles;
      }
    }
    angles += change * std::min(1.0, kLargestReachStep / std::max(largest, kLargestReachStep));
  }
  if (nearest <= 1e-6)
    refuse_reach(asked.place,
                 "the arm does not settle there; it is singular or near to it, or cannot turn the tool so");
  std::array<char, 120> text{};
  std::snprintf(text.data(), text.size(), "the arm does not reach there; the nearest it came is %.1f mm away",
                1e3 * nearest);
  refuse_reach(asked.place, text.data());
}

JointVector reach(const Arm& arm, const Eigen::Vector3d& place) {
  const JointVector home = home_angles(arm);
  return reach(arm, {place, tool_pose(arm, home).turned}, home);
}

}  // namespace stillcut
