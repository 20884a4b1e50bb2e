#include "models/arm_dynamics.hpp"

#include <Eigen/Geometry>
#include <cmath>

namespace stillcut {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

const ArmJoint& joint_of(const Arm& arm, int i) { return arm.joints[static_cast<std::size_t>(i)]; }

// A link's turning, and the velocity of its joint's origin.
struct LinkMotion {
  Vector3d turning, at_joint;
};
using LinkMotions = std::array<LinkMotion, kMostJoints>;

void link_motions(int n, const ArmPose& pose, const JointVector& velocities, LinkMotions& motions) {
  Vector3d turning = Vector3d::Zero(), moving = Vector3d::Zero();
  for (std::size_t i = 0; i < static_cast<std::size_t>(n); ++i) {
    if (i > 0) moving += turning.cross(Vector3d(pose.joint[i] - pose.joint[i - 1]));
    turning += velocities[static_cast<Eigen::Index>(i)] * pose.axis[i];
    motions[i] = {turning, moving};
  }
}

// Momentum of all that a joint carries, and its moment about the joint's origin.
struct Carried {
  Vector3d linear = Vector3d::Zero(), angular = Vector3d::Zero();

  void add(const Arm& arm, const ArmPose& pose, std::size_t i, const LinkMotion& motion) {
    const ArmJoint& joint = arm.joints[i];
    const Vector3d arm_of_centre = pose.centre[i] - pose.joint[i];
    const Vector3d push = joint.mass * (motion.at_joint + motion.turning.cross(arm_of_centre));
    const Vector3d own = pose.turned[i] * (joint.inertia * (pose.turned[i].transpose() * motion.turning));
    angular += own + arm_of_centre.cross(push);
    linear += push;
  }
  void move_to_joint(const ArmPose& pose, std::size_t i) {  // from joint i + 1 to joint i
    angular += Vector3d(pose.joint[i + 1] - pose.joint[i]).cross(linear);
  }
};

}  // namespace

ArmPose arm_pose(const Arm& arm, const JointVector& angles) {
  ArmPose pose;
  Matrix3d turned = Matrix3d::Identity();
  Vector3d origin = Vector3d::Zero();
  for (std::size_t i = 0; i < arm.joints.size(); ++i) {
    const ArmJoint& joint = arm.joints[i];
    origin += turned * joint.origin;
    const Matrix3d at_zero = turned * joint.turned;
    // Rodrigues: columns turned about the axis.
    const double angle = angles[static_cast<Eigen::Index>(i)], c = std::cos(angle), s = std::sin(angle);
    const Vector3d& u = joint.axis;
    Matrix3d rotation;
    const double v = 1.0 - c;
    rotation << c + u.x() * u.x() * v, u.x() * u.y() * v - u.z() * s, u.x() * u.z() * v + u.y() * s,
        u.y() * u.x() * v + u.z() * s, c + u.y() * u.y() * v, u.y() * u.z() * v - u.x() * s,
        u.z() * u.x() * v - u.y() * s, u.z() * u.y() * v + u.x() * s, c + u.z() * u.z() * v;
    pose.axis[i] = at_zero * u;
    turned = at_zero * rotation;
    pose.joint[i] = origin;
    pose.turned[i] = turned;
    pose.centre[i] = origin + turned * joint.centre;
  }
  pose.tool = origin + turned * arm.tool;
  return pose;
}

ToolJacobian tool_jacobian(const Arm& arm, const ArmPose& pose) {
  ToolJacobian jacobian(3, arm.size());
  for (std::size_t i = 0; i < arm.joints.size(); ++i)
    jacobian.col(static_cast<Eigen::Index>(i)) = pose.axis[i].cross(Vector3d(pose.tool - pose.joint[i]));
  return jacobian;
}

ToolJacobian turning_jacobian(const Arm& arm, const ArmPose& pose) {
  ToolJacobian jacobian(3, arm.size());
  for (std::size_t i = 0; i < arm.joints.size(); ++i) jacobian.col(static_cast<Eigen::Index>(i)) = pose.axis[i];
  return jacobian;
}

EquationsOfMotion equations_of_motion(const Arm& arm, const ArmPose& pose, const JointVector& velocities) {
  const int n = arm.size();
  EquationsOfMotion equations{JointMatrix::Zero(n, n), JointVector::Zero(n), JointVector::Zero(n)};
  // What the joint origins and links are accelerated by while no joint accelerates.
  Vector3d turning = Vector3d::Zero(), turned_faster = Vector3d::Zero(), joint_acceleration = Vector3d::Zero();
  for (int i = 0; i < n; ++i) {
    const auto at = static_cast<std::size_t>(i);
    if (i > 0) {
      const Vector3d link = pose.joint[at] - pose.joint[at - 1];
      joint_acceleration += turned_faster.cross(link) + turning.cross(turning.cross(link));
    }
    turned_faster += turning.cross(Vector3d(velocities[i] * pose.axis[at]));
    turning += velocities[i] * pose.axis[at];
    const Vector3d arm_of_centre = pose.centre[at] - pose.joint[at];
    const Vector3d acceleration =
        joint_acceleration + turned_faster.cross(arm_of_centre) + turning.cross(turning.cross(arm_of_centre));

    const double mass = joint_of(arm, i).mass;
    const Matrix3d inertia = pose.turned[at] * joint_of(arm, i).inertia * pose.turned[at].transpose();
    const Vector3d moment = inertia * turned_faster + turning.cross(Vector3d(inertia * turning));
    const Vector3d weight{0.0, 0.0, -mass * arm.gravity};
    ToolJacobian d(3, i + 1), theta(3, i + 1);  // partial velocities of the body
    for (int j = 0; j <= i; ++j) {
      const auto from = static_cast<std::size_t>(j);
      theta.col(j) = pose.axis[from];
      d.col(j) = pose.axis[from].cross(Vector3d(pose.centre[at] - pose.joint[from]));
    }
    equations.mass.topLeftCorner(i + 1, i + 1) += mass * d.transpose() * d + theta.transpose() * inertia * theta;
    equations.coriolis.head(i + 1) += d.transpose() * (mass * acceleration) + theta.transpose() * moment;
    equations.gravity.head(i + 1) -= d.transpose() * weight;
  }
  return equations;
}

JointMatrix gravity_stiffness(const Arm& arm, const ArmPose& pose) {
  const int n = arm.size();
  JointMatrix stiffness(n, n);
  double mass = 0.0;
  Vector3d moment = Vector3d::Zero();  // sum of mass times place
  for (int k = n - 1; k >= 0; --k) {
    const auto at = static_cast<std::size_t>(k);
    mass += joint_of(arm, k).mass;
    moment += joint_of(arm, k).mass * pose.centre[at];
    // Turning joint k moves all that it carries; a joint j before it feels that through its own axis.
    const Vector3d moved = pose.axis[at].cross(Vector3d(moment - mass * pose.joint[at]));
    for (int j = 0; j <= k; ++j) {
      const Vector3d& axis = pose.axis[static_cast<std::size_t>(j)];
      stiffness(j, k) = stiffness(k, j) = arm.gravity * axis.cross(moved).z();
    }
  }
  return stiffness;
}

JointVector momenta(const Arm& arm, const ArmPose& pose, const JointVector& velocities) {
  const int n = arm.size();
  LinkMotions motions;
  link_motions(n, pose, velocities, motions);
  JointVector result(n);
  Carried carried;
  for (int k = n - 1; k >= 0; --k) {
    const auto at = static_cast<std::size_t>(k);
    if (k + 1 < n) carried.move_to_joint(pose, at);
    carried.add(arm, pose, at, motions[at]);
    result[k] = pose.axis[at].dot(carried.angular);
  }
  return result;
}

// A turn of joint k is the same as a turn of all that lies before it the other way round: what the joint carries stays
// and only the motion that it is given (turning W, velocity U of the joint's origin) turns, by -z_k x. So the slope is
// that change of motion times the carried momentum.
JointVector kinetic_slope(const Arm& arm, const ArmPose& pose, const JointVector& a, const JointVector& b) {
  const int n = arm.size();
  LinkMotions motions_a, motions_b;
  link_motions(n, pose, a, motions_a);
  link_motions(n, pose, b, motions_b);
  JointVector slope(n);
  Carried carried_a, carried_b;
  for (int k = n - 1; k >= 0; --k) {
    const auto at = static_cast<std::size_t>(k);
    if (k + 1 < n) {
      carried_a.move_to_joint(pose, at);
      carried_b.move_to_joint(pose, at);
    }
    carried_a.add(arm, pose, at, motions_a[at]);
    carried_b.add(arm, pose, at, motions_b[at]);
    const Vector3d turn =
        motions_a[at].at_joint.cross(carried_b.linear) + motions_a[at].turning.cross(carried_b.angular) +
        motions_b[at].at_joint.cross(carried_a.linear) + motions_b[at].turning.cross(carried_a.angular);
    slope[k] = -0.5 * pose.axis[at].dot(turn);
  }
  return slope;
}

JointVector gravity_torques(const Arm& arm, const ArmPose& pose) {
  const int n = arm.size();
  JointVector torques(n);
  double mass = 0.0;
  Vector3d moment = Vector3d::Zero();
  for (int k = n - 1; k >= 0; --k) {
    const auto at = static_cast<std::size_t>(k);
    mass += joint_of(arm, k).mass;
    moment += joint_of(arm, k).mass * pose.centre[at];
    torques[k] = arm.gravity * pose.axis[at].cross(Vector3d(moment - mass * pose.joint[at])).z();
  }
  return torques;
}

double gravity_energy(const Arm& arm, const ArmPose& pose) {
  double energy = 0.0;
  for (std::size_t i = 0; i < arm.joints.size(); ++i) energy += arm.joints[i].mass * arm.gravity * pose.centre[i].z();
  return energy;
}

JointVector tool_torques(const Arm& arm, const ArmPose& pose, const Vector3d& force) {
  JointVector torques(arm.size());
  for (std::size_t i = 0; i < arm.joints.size(); ++i)
    torques[static_cast<Eigen::Index>(i)] = pose.axis[i].dot(Vector3d(pose.tool - pose.joint[i]).cross(force));
  return torques;
}

Vector3d tool_velocity(const Arm& arm, const ArmPose& pose, const JointVector& velocities) {
  Vector3d sum = Vector3d::Zero();
  for (std::size_t i = 0; i < arm.joints.size(); ++i)
    sum += velocities[static_cast<Eigen::Index>(i)] * pose.axis[i].cross(Vector3d(pose.tool - pose.joint[i]));
  return sum;
}

Vector3d tool_convective_acceleration(const Arm& arm, const ArmPose& pose, const JointVector& velocities) {
  Vector3d turning = Vector3d::Zero(), faster = Vector3d::Zero(), acceleration = Vector3d::Zero();
  for (std::size_t i = 0; i < arm.joints.size(); ++i) {
    const Vector3d own = velocities[static_cast<Eigen::Index>(i)] * pose.axis[i];
    faster += turning.cross(own);
    turning += own;
    const Vector3d& next = i + 1 < arm.joints.size() ? pose.joint[i + 1] : pose.tool;
    const Vector3d link = next - pose.joint[i];
    acceleration += faster.cross(link) + turning.cross(turning.cross(link));
  }
  return acceleration;
}

}  // namespace stillcut
