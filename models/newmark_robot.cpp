#include "models/newmark_robot.hpp"

#include <Eigen/Cholesky>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "models/arm_modes.hpp"

namespace stillcut {
namespace {

constexpr double kSettled = 1e-10;       // correction to the velocities, of the largest; the next would be far smaller
constexpr double kSettledSpeed = 1e-17;  // rad/s: an arm at rest
constexpr int kMostIterations = 25;
constexpr int kUsualIterations = 4;      // more: the inverse is that of a posture too far away
constexpr double kMostDeflection = 0.2;  // rad: no gearbox gives so much, and the springs are linear for far less
constexpr double kMostStep = std::numbers::pi;  // of the fastest mode's phase

JointVector solve_mass(const Arm& arm, const ArmPose& pose, const JointVector& right) {
  const JointMatrix mass = equations_of_motion(arm, pose, JointVector::Zero(arm.size())).mass;
  return mass.llt().solve(right);
}

}  // namespace

JointPath holding(const JointVector& angles) {
  return [angles](double) { return angles; };
}

NewmarkRobot::NewmarkRobot(Arm arm, JointPath command, double step)
    : arm_{std::move(arm)}, command_{std::move(command)}, step_{step} {
  check_arm(arm_);
  if (!(step_ > 0.0) || !std::isfinite(step_)) throw std::invalid_argument("the step of a robot must be positive");
  const int n = arm_.size();
  command_angles_ = command_(0.0);
  if (command_angles_.size() != n) throw std::invalid_argument("the command has another number of joints than the arm");
  stiffness_.resize(n);
  damping_.resize(n);
  for (int i = 0; i < n; ++i) {
    stiffness_[i] = arm_.joints[static_cast<std::size_t>(i)].stiffness;
    damping_[i] = arm_.joints[static_cast<std::size_t>(i)].damping;
  }
  const double fastest = highest_frequency(linear_arm(arm_, command_angles_));
  if (fastest * step_ > kMostStep) {
    std::array<char, 120> text{};
    std::snprintf(text.data(), text.size(),
                  "the step of %.3g ms is too large: the arm's fastest mode, %.1f Hz, needs less than %.3g ms",
                  1e3 * step_, fastest / (2.0 * std::numbers::pi), 1e3 * kMostStep / fastest);
    stop(text.data());
  }
  pose_ = arm_pose(arm_, command_angles_);
  compensation_ = gravity_torques(arm_, pose_);
  deflections_ = JointVector::Zero(n);
  command_velocities_ = (command_(step_) - command_angles_) / step_;
  velocities_ = command_velocities_;
  momenta_ = momenta(arm_, pose_, velocities_);
  last_change_ = JointVector::Zero(n);
  command_tool_ = pose_.tool;
  command_tool_velocity_ = tool_velocity(arm_, pose_, velocities_);
  command_tool_acceleration_.setZero();
  refactor();
}

void NewmarkRobot::refactor() {
  const int n = arm_.size();
  JointMatrix matrix = equations_of_motion(arm_, pose_, JointVector::Zero(n)).mass;
  matrix.diagonal() += step_ / 2.0 * damping_ + step_ * step_ / 4.0 * stiffness_;
  inverse_ = matrix.llt().solve(JointMatrix::Identity(n, n));
  stale_ = false;
}

NewmarkRobot::Command NewmarkRobot::command_after() const {
  Command command;
  try {
    command.end = command_(time_ + step_);
  } catch (const std::invalid_argument& error) {
    stop(error.what());
  }
  command.change = command.end - command_angles_;
  command.middle = command_angles_ + 0.5 * command.change;
  const bool stands = (command.change.array() == 0.0).all();
  command.compensation = stands ? compensation_ : gravity_torques(arm_, arm_pose(arm_, command.middle));
  return command;
}

// What changes the momenta over the step, in its middle, when it ends at the velocities `next`.
JointVector NewmarkRobot::torques(const Command& command, const Eigen::Vector3d& force, const JointVector& next) const {
  const JointVector mean = 0.5 * (velocities_ + next);
  const JointVector deflections = deflections_ + 0.5 * (step_ * mean - command.change);
  const ArmPose pose = arm_pose(arm_, command.middle + deflections);
  JointVector damped = mean;
  if (!arm_.damps_joint_velocity) damped -= command.change / step_;
  return kinetic_slope(arm_, pose, velocities_, next) - stiffness_.cwiseProduct(deflections) -
         damping_.cwiseProduct(damped) - gravity_torques(arm_, pose) + command.compensation +
         tool_torques(arm_, pose, force);
}

void NewmarkRobot::advance(const Eigen::Vector3d& begin, const Eigen::Vector3d& end) {
  const Command command = command_after();
  const Eigen::Vector3d force = 0.5 * (begin + end);
  if (stale_) refactor();
  JointVector next = velocities_ + last_change_;
  JointVector deflections, moved;
  ArmPose pose;
  int iteration = 0;
  for (double correction = 0.0;;) {
    if (iteration == kMostIterations) stop("the step is too large: its equations do not settle");
    deflections = deflections_ + 0.5 * step_ * (velocities_ + next) - command.change;
    if (!(deflections.cwiseAbs().maxCoeff() <= kMostDeflection)) {
      Eigen::Index joint = 0;
      deflections.cwiseAbs().maxCoeff(&joint);
      stop(arm_.joints[static_cast<std::size_t>(joint)].name +
           " leaves its command by more than 0.2 rad; the motion diverges: the cut is unstable, the force too large or "
           "the step too long");
    }
    pose = arm_pose(arm_, command.end + deflections);
    moved = momenta(arm_, pose, next);
    if (iteration > 0 && correction <= kSettled * next.cwiseAbs().maxCoeff() + kSettledSpeed) break;
    const JointVector change = inverse_ * (momenta_ + step_ * torques(command, force, next) - moved);
    next += change;
    correction = change.cwiseAbs().maxCoeff();
    ++iteration;
  }
  iterations_ += iteration;
  stale_ = iteration > kUsualIterations;
  last_change_ = next - velocities_;
  velocities_ = next;
  deflections_ = deflections;
  momenta_ = moved;
  pose_ = pose;
  time_ += step_;
  force_ = end;
  if ((command.change.array() == 0.0).all()) {
    command_velocities_.setZero();
    command_tool_velocity_.setZero();
    command_tool_acceleration_.setZero();
    return;
  }
  command_angles_ = command.end;
  const ArmPose commanded = arm_pose(arm_, command_angles_);
  compensation_ = gravity_torques(arm_, commanded);
  command_velocities_ = command.change / step_;
  const Eigen::Vector3d tool_velocity_now = (commanded.tool - command_tool_) / step_;
  command_tool_acceleration_ = (tool_velocity_now - command_tool_velocity_) / step_;
  command_tool_velocity_ = tool_velocity_now;
  command_tool_ = commanded.tool;
}

Eigen::Vector3d NewmarkRobot::displacement_after(const Eigen::Vector3d& begin, const Eigen::Vector3d& end) const {
  const Command command = command_after();
  const JointVector guess = velocities_ + last_change_;
  const JointVector reached = momenta(arm_, arm_pose(arm_, angles() + 0.5 * step_ * (velocities_ + guess)), guess);
  const JointVector next =
      guess + inverse_ * (momenta_ + step_ * torques(command, 0.5 * (begin + end), guess) - reached);
  const JointVector after = angles() + 0.5 * step_ * (velocities_ + next);
  return arm_pose(arm_, after).tool - arm_pose(arm_, command.end).tool;
}

void NewmarkRobot::strike(const Eigen::Vector3d& impulse) {
  momenta_ += tool_torques(arm_, pose_, impulse);
  velocities_ = solve_mass(arm_, pose_, momenta_);
  last_change_.setZero();
}

Eigen::Vector3d NewmarkRobot::displacement() const { return pose_.tool - command_tool_; }

Eigen::Vector3d NewmarkRobot::velocity() const {
  return tool_velocity(arm_, pose_, velocities_) - command_tool_velocity_;
}

Eigen::Vector3d NewmarkRobot::acceleration() const {
  const EquationsOfMotion equations = equations_of_motion(arm_, pose_, velocities_);
  JointVector damped = velocities_;
  if (!arm_.damps_joint_velocity) damped -= command_velocities_;
  const JointVector torque = tool_torques(arm_, pose_, force_) + compensation_ - stiffness_.cwiseProduct(deflections_) -
                             damping_.cwiseProduct(damped) - equations.gravity - equations.coriolis;
  const JointVector accelerations = equations.mass.llt().solve(torque);
  return tool_velocity(arm_, pose_, accelerations) + tool_convective_acceleration(arm_, pose_, velocities_) -
         command_tool_acceleration_;
}

double NewmarkRobot::energy() const {
  const ArmPose commanded = arm_pose(arm_, command_angles_);
  return 0.5 * velocities_.dot(momenta_) + 0.5 * deflections_.dot(stiffness_.cwiseProduct(deflections_)) +
         gravity_energy(arm_, pose_) - gravity_energy(arm_, commanded) - compensation_.dot(deflections_);
}

void NewmarkRobot::stop(const std::string& reason) const {
  std::array<char, 40> at{};
  std::snprintf(at.data(), at.size(), "at %.6g s: ", time_);
  throw std::runtime_error(at.data() + reason);
}

}  // namespace stillcut
