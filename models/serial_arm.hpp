// A serial arm through KDL (Orocos Kinematics and Dynamics Library, Debian's liborocos-kdl): any number of joints up to
// kMostJoints, with the recursive algorithms that the robotics world uses and tests. It gives the modes of a robot read
// from a file. Our own equations (models/arm_dynamics) are held against it to 1e-9 and run where it would be slow: in
// every time step.
#pragma once

#include <Eigen/Core>
#include <memory>

#include "models/arm.hpp"
#include "models/arm_dynamics.hpp"
#include "models/arm_modes.hpp"

namespace stillcut {

// Not for several threads at once: the solvers keep their work space. Every `angles` and `velocities` is one a joint,
// rad and rad/s. std::runtime_error where KDL reports a failure, by its name.
class SerialArm {
 public:
  // Throws std::invalid_argument for an arm that check_arm refuses.
  explicit SerialArm(Arm arm);
  ~SerialArm();
  SerialArm(SerialArm&&) noexcept;
  SerialArm& operator=(SerialArm&&) noexcept;

  [[nodiscard]] const Arm& description() const;
  [[nodiscard]] Eigen::Vector3d tool(const JointVector& angles);   // m, base axes
  [[nodiscard]] ToolJacobian jacobian(const JointVector& angles);  // m/rad, of the tool point
  [[nodiscard]] EquationsOfMotion equations(const JointVector& angles, const JointVector& velocities);
  // As linear_arm, the mass matrix and the Jacobian from KDL.
  [[nodiscard]] LinearArm linearised(const JointVector& angles);

 private:
  struct Solvers;
  std::unique_ptr<Solvers> solvers_;
};

}  // namespace stillcut
