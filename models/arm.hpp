// An arm whose joints give: rigid links, and in every joint a spring and a damper between where the motor stands and
// where the link is. One description serves the paper's four-axis robot (models/four_axis_arm), any serial robot from a
// URDF file (drivers/files/robot_file) and everything that is computed from them.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <string>
#include <vector>

namespace stillcut {

inline constexpr int kMostJoints = 8;  // so that nothing an arm needs in a time step lies on the heap

using JointVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMostJoints, 1>;
using JointMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMostJoints, kMostJoints>;
using ToolJacobian = Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, kMostJoints>;

// A turning joint and the link that it carries. The link's frame has its origin on the joint and turns with it.
struct ArmJoint {
  std::string name;
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();      // m, in the frame of the link before
  Eigen::Matrix3d turned = Eigen::Matrix3d::Identity();  // from this link's axes to the former's, at angle 0
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();       // unit, in the link's own frame
  double stiffness = 0.0;                                // N m/rad
  double damping = 0.0;                                  // N m s/rad
  double home = 0.0;                                     // rad
  double lower = -std::numeric_limits<double>::infinity(), upper = std::numeric_limits<double>::infinity();  // rad

  double mass = 0.0;                                      // kg, of the link
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();       // m, of mass, in the link's frame
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Identity();  // kg m^2, about the centre of mass, in the link's axes
};

// The frame of the base is the workpiece frame: z up, gravity along -z.
struct Arm {
  std::string name;
  std::vector<ArmJoint> joints;                    // from the base to the tool
  Eigen::Vector3d tool = Eigen::Vector3d::Zero();  // m, tool point in the last link's frame
  double gravity = 9.81;                           // m/s^2
  // Damps each joint's own velocity (Huynh et al. 2017, eq. 7) rather than its velocity past its command. The same
  // while the command stands still; on the move the former drags the tool behind its path by D q'/K.
  bool damps_joint_velocity = false;

  [[nodiscard]] int size() const { return static_cast<int>(joints.size()); }
};

// Throws std::invalid_argument, naming the joint, unless: 1 to kMostJoints joints; finite numbers; stiffness > 0,
// damping >= 0, axis of length 1; mass >= 0; inertia symmetric, without negative principal moments, and each of these
// at most the sum of the other two; lower <= home <= upper; and every joint moves some mass.
void check_arm(const Arm& arm);

// Home angles, rad.
JointVector home_angles(const Arm& arm);

// Empty, or why an arm must not stand there: "joint_2 at 95.0 deg is beyond its limits, -90.0 to 90.0 deg".
std::string beyond_limits(const Arm& arm, const JointVector& angles);

}  // namespace stillcut
