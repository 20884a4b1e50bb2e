// A robot arm in time, fast: the vibration modes of its posture, each updated exactly (models/modal_structure), and new
// ones whenever the posture has moved on. For small vibrations about a slowly moving posture it is the whole robot
// (models/newmark_robot) at a fraction of the cost; what it leaves out is said in docs/robot.md.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "models/arm_modes.hpp"
#include "models/modal_structure.hpp"
#include "models/newmark_robot.hpp"
#include "models/structure.hpp"

namespace stillcut {

class LinearisedRobot final : public Structure {
 public:
  // `linearise` gives the arm at a posture: [&](const JointVector& q) { return linear_arm(arm, q); }, or SerialArm's
  // own. `step` in s. The modes are those of the posture at most `stale` rad (largest joint) away. Throws
  // std::invalid_argument as arm_modes and ModalStructure, and std::runtime_error for a step longer than half a period
  // of the highest mode at the tool.
  LinearisedRobot(Linearise linearise, JointPath command, double step, double stale = 0.01);

  [[nodiscard]] Eigen::Vector3d displacement_after(const Eigen::Vector3d& begin,
                                                   const Eigen::Vector3d& end) const override;
  // Throws std::runtime_error, with the time and the reason, where the tool is more than 0.1 m from its command, the
  // motion is not finite, the posture that the arm has come to has no modes, or the command says
  // (std::invalid_argument) that the arm cannot follow.
  void advance(const Eigen::Vector3d& begin, const Eigen::Vector3d& end) override;
  void strike(const Eigen::Vector3d& impulse) override { structure_.strike(impulse); }
  [[nodiscard]] Eigen::Vector3d displacement() const override { return structure_.displacement(); }
  [[nodiscard]] Eigen::Vector3d velocity() const override { return structure_.velocity(); }
  [[nodiscard]] Eigen::Vector3d acceleration() const override { return structure_.acceleration(); }

  [[nodiscard]] double time() const { return time_; }                  // s
  [[nodiscard]] double energy() const { return structure_.energy(); }  // J, of the modes
  [[nodiscard]] int linearisations() const { return linearisations_; }

 private:
  void linearise_at(const JointVector& angles);
  [[noreturn]] void stop(const std::string& reason) const;

  Linearise linearise_;
  JointPath command_;
  double step_, stale_, time_ = 0.0;
  JointVector posture_;  // of the modes
  std::vector<ArmMode> modes_;
  ModalStructure structure_;
  int linearisations_ = 1;
};

}  // namespace stillcut
