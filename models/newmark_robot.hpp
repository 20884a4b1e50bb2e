// A robot arm in time, whole: the nonlinear equations of motion of all its links, its joints' springs and dampers,
// gravity and its compensation, the force at the tool. As the milling simulation's structure it is the multibody
// paper's (Huynh et al. 2017), for any arm.
//
// The rule is Newmark's with average acceleration (1/4, 1/2), iterated until it holds, but written for the joints'
// momenta p = M(q) v instead of their accelerations (after Simo and Tarnow 1992): over a step h
//   q1 - q0 = h (v0 + v1)/2
//   p1 - p0 = h (T' - K (x0 + x1)/2 - C (v0 + v1)/2 - g(q) + g(q_ref) + J(q)^T F)   at q = (q0 + q1)/2
// T' the slope of v0^T M v1 / 2. Where M does not depend on the posture that is Newmark's rule to the last bit; where
// it does, Newmark's gains or loses energy of its own, and this one does not: multiply by v0 + v1.
#pragma once

#include <Eigen/Core>
#include <functional>

#include "models/arm_dynamics.hpp"
#include "models/structure.hpp"

namespace stillcut {

// The joint angles that a controller commands, rad, at a time in s from the structure's start.
using JointPath = std::function<JointVector(double time)>;

// A command that stands still.
JointPath holding(const JointVector& angles);

class NewmarkRobot final : public Structure {
 public:
  // `step` in s. Each joint's motor bears the weight that it would bear at the commanded angles, so that an arm at rest
  // stands where it is commanded to (the paper compensates joints 1 and 2; its vertical joint and its vertical spindle
  // bear no weight). Throws std::invalid_argument for an arm that check_arm refuses or a step that is not positive, and
  // std::runtime_error for a step longer than half a period of the arm's fastest mode.
  NewmarkRobot(Arm arm, JointPath command, double step);

  // The tool point after one iteration: off by second order in the step, of the motion's nonlinear part only.
  [[nodiscard]] Eigen::Vector3d displacement_after(const Eigen::Vector3d& begin,
                                                   const Eigen::Vector3d& end) const override;
  // Throws std::runtime_error, with the time and the reason, where the iteration does not settle, a joint is more than
  // 0.2 rad from its command, or the motion is not finite; or where the
  // command says (std::invalid_argument) that the arm cannot follow. The state is then that before the step.
  void advance(const Eigen::Vector3d& begin, const Eigen::Vector3d& end) override;
  void strike(const Eigen::Vector3d& impulse) override;
  [[nodiscard]] Eigen::Vector3d displacement() const override;
  [[nodiscard]] Eigen::Vector3d velocity() const override;
  [[nodiscard]] Eigen::Vector3d acceleration() const override;

  [[nodiscard]] double time() const { return time_; }                                  // s
  [[nodiscard]] JointVector angles() const { return command_angles_ + deflections_; }  // rad
  [[nodiscard]] const JointVector& velocities() const { return velocities_; }          // rad/s

  // Kinetic energy, that of the springs, and that of weight less its compensation, J: 0 at rest at the command.
  [[nodiscard]] double energy() const;
  // Solutions of the step's equations so far, for benchmarks.
  [[nodiscard]] long iterations() const { return iterations_; }

 private:
  struct Command {  // over a step: middle angles, change, and what bears the weight in the middle
    JointVector end, middle, change, compensation;
  };
  [[nodiscard]] Command command_after() const;  // stops where the arm cannot follow its path
  [[nodiscard]] JointVector torques(const Command& command, const Eigen::Vector3d& force,
                                    const JointVector& next) const;
  void refactor();
  [[noreturn]] void stop(const std::string& reason) const;

  Arm arm_;
  JointPath command_;
  double step_, time_ = 0.0;
  JointVector stiffness_, damping_;
  JointVector command_angles_, compensation_, command_velocities_;
  JointVector deflections_, velocities_, momenta_, last_change_;
  ArmPose pose_;
  JointMatrix inverse_;  // of M + h C / 2 + h^2 K / 4 at some posture near by
  Eigen::Vector3d force_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d command_tool_, command_tool_velocity_, command_tool_acceleration_;
  long iterations_ = 0;
  bool stale_ = false;  // the inverse: the posture has moved on
};

}  // namespace stillcut
