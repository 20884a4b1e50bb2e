#include "models/four_axis_arm.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <stdexcept>

namespace stillcut {
namespace {

constexpr double kSingularShare = 1e-3;  // of the reach: nearer to its limit an arm counts as stretched or folded

ArmJoint four_axis_link(const char* name, double from, const Eigen::Vector3d& axis, double mass,
                        const Eigen::Vector3d& inertia, double length, double stiffness, double damping) {
  ArmJoint joint;
  joint.name = name;
  joint.origin = {0.0, 0.0, from};
  joint.axis = axis;
  joint.mass = mass;
  joint.centre = {0.0, 0.0, 0.5 * length};
  joint.inertia = inertia.asDiagonal();
  joint.stiffness = stiffness;
  joint.damping = damping;
  return joint;
}

[[noreturn]] void refuse_place(const Eigen::Vector3d& place, const char* reason) {
  std::array<char, 200> text{};
  std::snprintf(text.data(), text.size(), "the tool cannot be at %.1f,%.1f,%.1f mm: %s", 1e3 * place.x(),
                1e3 * place.y(), 1e3 * place.z(), reason);
  throw std::invalid_argument(text.data());
}

}  // namespace

Arm huynh_robot() {
  const FourAxisLengths l;
  const Eigen::Vector3d y = Eigen::Vector3d::UnitY(), z = Eigen::Vector3d::UnitZ();
  Arm arm;
  arm.name = "Huynh et al. 2017";
  arm.joints = {
      four_axis_link("joint_1", 0.0, z, 342, {18.044, 29.213, 30.014}, l.shoulder, 3.8e6, 1057.2),
      four_axis_link("joint_2", l.shoulder, y, 243, {35.033, 37.463, 4.050}, l.main_arm, 6.6e6, 1393.3),
      four_axis_link("joint_3", l.main_arm, y, 202, {5.507, 5.507, 4.547}, l.forearm, 3.9e6, 1071.0),
      four_axis_link("joint_4", l.forearm, y, 11, {0.103, 0.103, 0.041}, l.spindle, 0.66e6, 440.6),
  };
  arm.tool = {0.0, 0.0, l.spindle};
  arm.damps_joint_velocity = true;
  const JointVector home = four_axis_angles(l, {1.1, 0.0, 0.0});
  for (std::size_t i = 0; i < arm.joints.size(); ++i) arm.joints[i].home = home[static_cast<Eigen::Index>(i)];
  return arm;
}

JointVector four_axis_angles(const FourAxisLengths& lengths, const Eigen::Vector3d& place) {
  const double a = lengths.main_arm, b = lengths.forearm;
  if (!place.allFinite()) throw std::invalid_argument("the tool's place is not finite");
  const double out = std::hypot(place.x(), place.y()), up = place.z() + lengths.spindle - lengths.shoulder;
  const double far = std::hypot(out, up);  // from shoulder to wrist
  const double singular = kSingularShare * (a + b);
  if (far > a + b) refuse_place(place, "the arm does not reach so far");
  if (far < std::abs(a - b)) refuse_place(place, "the arm does not reach so near to its shoulder");
  if (far > a + b - singular) refuse_place(place, "the arm is singular there, stretched");
  if (far < std::abs(a - b) + singular) refuse_place(place, "the arm is singular there, folded");
  if (out < singular) refuse_place(place, "the arm is singular there, the tool on the axis of joint 1");
  const double at_shoulder = std::acos((a * a + far * far - b * b) / (2.0 * a * far));
  const double at_elbow = std::acos((a * a + b * b - far * far) / (2.0 * a * b));
  JointVector angles(4);
  angles[0] = std::atan2(place.y(), place.x());
  angles[1] = std::atan2(out, up) - at_shoulder;
  angles[2] = std::numbers::pi - at_elbow;
  angles[3] = std::numbers::pi - angles[1] - angles[2];  // the spindle points down
  return angles;
}

}  // namespace stillcut
