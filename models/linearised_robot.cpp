#include "models/linearised_robot.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <stdexcept>
#include <utility>

namespace stillcut {
namespace {

constexpr double kMostExcursion = 0.1;  // m: beyond it no robot is linear, nor cuts

std::vector<Mode> modes_only(const std::vector<ArmMode>& modes) {
  std::vector<Mode> result;
  result.reserve(modes.size());
  for (const ArmMode& mode : modes) result.push_back(mode.mode);
  return result;
}

}  // namespace

LinearisedRobot::LinearisedRobot(Linearise linearise, JointPath command, double step, double stale)
    : linearise_{std::move(linearise)},
      command_{std::move(command)},
      step_{step},
      stale_{stale},
      posture_{command_(0.0)},
      modes_{arm_modes(linearise_(posture_))},
      structure_{modes_only(modes_), step} {
  if (!(stale_ > 0.0)) throw std::invalid_argument("the posture change that asks for new modes must be above 0");
  const double fastest = modes_.back().mode.natural_frequency;
  if (fastest * step_ <= std::numbers::pi) return;
  std::array<char, 120> text{};
  std::snprintf(text.data(), text.size(),
                "the step of %.3g ms is too large: the arm's mode at %.1f Hz needs less than %.3g ms", 1e3 * step_,
                fastest / (2.0 * std::numbers::pi), 1e3 * std::numbers::pi / fastest);
  stop(text.data());
}

// The joints' deflections and velocities go over; what a mode that is left out would carry is lost.
void LinearisedRobot::linearise_at(const JointVector& angles) {
  const LinearArm linear = linearise_(angles);
  std::vector<ArmMode> modes = arm_modes(linear);
  JointVector deflections = JointVector::Zero(angles.size()), velocities = deflections;
  const std::vector<ModalMotion> motion = structure_.motion();
  for (std::size_t r = 0; r < modes_.size(); ++r) {
    deflections += motion[r].displacement / modes_[r].reach * modes_[r].shape;
    velocities += motion[r].velocity / modes_[r].reach * modes_[r].shape;
  }
  std::vector<ModalMotion> next;
  for (const ArmMode& mode : modes) {
    const JointVector weighed = linear.mass * mode.shape;
    next.push_back({mode.reach * weighed.dot(deflections), mode.reach * weighed.dot(velocities)});
  }
  structure_ = ModalStructure(modes_only(modes), step_);
  structure_.set_motion(next);
  modes_ = std::move(modes);
  posture_ = angles;
  ++linearisations_;
}

Eigen::Vector3d LinearisedRobot::displacement_after(const Eigen::Vector3d& begin, const Eigen::Vector3d& end) const {
  return structure_.displacement_after(begin, end);
}

void LinearisedRobot::advance(const Eigen::Vector3d& begin, const Eigen::Vector3d& end) {
  try {
    const JointVector angles = command_(time_);
    if (!((angles - posture_).cwiseAbs().maxCoeff() <= stale_)) linearise_at(angles);
  } catch (const std::invalid_argument& error) {
    stop(error.what());
  }
  structure_.advance(begin, end);
  time_ += step_;
  if (structure_.displacement().norm() <= kMostExcursion) return;
  stop(
      "the tool leaves its command by more than 0.1 m; the motion diverges: the cut is unstable or the force too "
      "large");
}

void LinearisedRobot::stop(const std::string& reason) const {
  std::array<char, 40> at{};
  std::snprintf(at.data(), at.size(), "at %.6g s: ", time_);
  throw std::runtime_error(at.data() + reason);
}

}  // namespace stillcut
