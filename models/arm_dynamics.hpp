// How an arm moves: where its links and its tool point are at given joint angles, what inertia the joints feel, what
// gravity asks of them. Two ways to the same equations: d'Alembert's principle body by body as the multibody paper
// writes it (Huynh et al. 2017, eq. 6), which is easy to check; and momenta summed from the tool to the base, which
// takes a few hundred nanoseconds and is what runs in time (models/newmark_robot).
#pragma once

#include <Eigen/Core>
#include <array>

#include "models/arm.hpp"

namespace stillcut {

// Where everything is at some joint angles; base axes, m. Only the first arm.size() entries count.
struct ArmPose {
  std::array<Eigen::Vector3d, kMostJoints> joint, axis, centre;  // centre: of mass of the link that the joint carries
  std::array<Eigen::Matrix3d, kMostJoints> turned;               // from the link's axes to the base's
  Eigen::Vector3d tool;
};

// `angles`: one a joint, rad.
ArmPose arm_pose(const Arm& arm, const JointVector& angles);

// How the tool point moves with the joints: m/rad, 3 x n, base axes.
ToolJacobian tool_jacobian(const Arm& arm, const ArmPose& pose);
// The same for turning: the joints' axes, 3 x n.
ToolJacobian turning_jacobian(const Arm& arm, const ArmPose& pose);

// M(q) q'' + coriolis + gravity = torques. kg m^2, N m, N m.
struct EquationsOfMotion {
  JointMatrix mass;
  JointVector coriolis;  // gyroscopic and Coriolis terms, quadratic in the joint velocities
  JointVector gravity;   // what the joints must bear for the arm to stay where it is
};

// By d'Alembert's principle (Huynh et al. 2017, eq. 6), from the bodies' partial velocities d^(i,j) and theta^(i,j).
// `velocities` in rad/s.
EquationsOfMotion equations_of_motion(const Arm& arm, const ArmPose& pose, const JointVector& velocities);

// d(gravity)/d(angles), N m/rad, symmetric: the stiffness that weight adds to the springs (or takes from them).
JointMatrix gravity_stiffness(const Arm& arm, const ArmPose& pose);

// M(q) v, kg m^2/s.
JointVector momenta(const Arm& arm, const ArmPose& pose, const JointVector& velocities);

// d/dq of a^T M(q) b / 2 with a and b (rad/s) held, N m. For a = b it is the derivative of the kinetic energy.
JointVector kinetic_slope(const Arm& arm, const ArmPose& pose, const JointVector& a, const JointVector& b);

// As EquationsOfMotion::gravity, N m.
JointVector gravity_torques(const Arm& arm, const ArmPose& pose);

// Of weight, J; zero where all centres of mass lie in the base's xy plane.
double gravity_energy(const Arm& arm, const ArmPose& pose);

// J(q)^T F, N m, for a force at the tool point, N, base axes.
JointVector tool_torques(const Arm& arm, const ArmPose& pose, const Eigen::Vector3d& force);

// J(q) v, m/s.
Eigen::Vector3d tool_velocity(const Arm& arm, const ArmPose& pose, const JointVector& velocities);

// J'(q, v) v, m/s^2: what the tool point is accelerated by at joint velocities that do not change.
Eigen::Vector3d tool_convective_acceleration(const Arm& arm, const ArmPose& pose, const JointVector& velocities);

}  // namespace stillcut
