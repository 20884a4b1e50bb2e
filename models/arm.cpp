#include "models/arm.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <stdexcept>

namespace stillcut {
namespace {

constexpr double kUnitTolerance = 1e-9;
constexpr double kSymmetryTolerance = 1e-9;  // of the largest moment of inertia
constexpr double kTriangleTolerance = 1e-6;  // of the sum of the moments: files round

// That a tensor belongs to a body of positive density: tr(I)/2 1 - I = sum m r r^T has no negative eigenvalue. Said by
// the principal minors, so that no eigenvalue solver is needed.
bool is_inertia(const Eigen::Matrix3d& inertia) {
  const double scale = inertia.cwiseAbs().maxCoeff();
  if ((inertia - inertia.transpose()).cwiseAbs().maxCoeff() > kSymmetryTolerance * scale) return false;
  const double trace = inertia.trace();
  const Eigen::Matrix3d spread = (0.5 + kTriangleTolerance) * trace * Eigen::Matrix3d::Identity() - inertia;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    if (spread(i, i) < 0.0 || spread(i, i) * spread(j, j) - spread(i, j) * spread(j, i) < 0.0) return false;
  }
  return spread.col(0).dot(spread.col(1).cross(spread.col(2))) >= 0.0;
}

double in_degrees(double rad) { return rad * 180.0 / std::numbers::pi; }

}  // namespace

void check_arm(const Arm& arm) {
  if (arm.joints.empty()) throw std::invalid_argument("the arm has no joint that moves");
  if (arm.size() > kMostJoints)
    throw std::invalid_argument("the arm has " + std::to_string(arm.size()) + " joints; up to " +
                                std::to_string(kMostJoints) + " are supported");
  if (!arm.tool.allFinite() || !std::isfinite(arm.gravity)) throw std::invalid_argument("the tool point is not finite");
  double carried = 0.0;
  for (auto joint = arm.joints.rbegin(); joint != arm.joints.rend(); ++joint) {
    const auto refuse = [&](const char* what) { throw std::invalid_argument("joint " + joint->name + ": " + what); };
    const bool finite = joint->origin.allFinite() && joint->turned.allFinite() && joint->axis.allFinite() &&
                        joint->centre.allFinite() && joint->inertia.allFinite() && std::isfinite(joint->mass);
    if (!finite) refuse("a length, mass or inertia is not finite");
    if (!(joint->stiffness > 0.0) || !std::isfinite(joint->stiffness)) refuse("its stiffness must be above 0");
    if (!(joint->damping >= 0.0) || !std::isfinite(joint->damping)) refuse("its damping must not be negative");
    if (std::abs(joint->axis.norm() - 1.0) > kUnitTolerance) refuse("its axis is no unit vector");
    if (!(joint->mass >= 0.0)) refuse("the mass of its link is negative");
    if (!is_inertia(joint->inertia)) refuse("no body has the inertia of its link; check ixx to izz");
    if (!(joint->lower <= joint->home && joint->home <= joint->upper)) refuse("its home angle is beyond its limits");
    carried += joint->mass + joint->inertia.trace();
    if (!(carried > 0.0)) refuse("it moves no mass: no link from it to the tool has an inertia");
  }
}

JointVector home_angles(const Arm& arm) {
  JointVector angles(arm.size());
  for (int i = 0; i < arm.size(); ++i) angles[i] = arm.joints[static_cast<std::size_t>(i)].home;
  return angles;
}

std::string beyond_limits(const Arm& arm, const JointVector& angles) {
  for (int i = 0; i < arm.size(); ++i) {
    const ArmJoint& joint = arm.joints[static_cast<std::size_t>(i)];
    if (angles[i] >= joint.lower - 1e-9 && angles[i] <= joint.upper + 1e-9) continue;
    std::array<char, 120> text{};
    std::snprintf(text.data(), text.size(), " at %.1f deg is beyond its limits, %.1f to %.1f deg",
                  in_degrees(angles[i]), in_degrees(joint.lower), in_degrees(joint.upper));
    return joint.name + text.data();
  }
  return {};
}

}  // namespace stillcut
