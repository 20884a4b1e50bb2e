#include "models/modal_structure.hpp"

#include <cmath>
#include <stdexcept>

namespace stillcut {

ModalStructure::ModalStructure(std::span<const Mode> modes, double step) : step_{step} {
  if (!(step > 0.0)) throw std::invalid_argument("the step of a modal structure must be positive");
  for (const Mode& mode : modes) {
    const Eigen::Vector3d direction{mode.direction[0], mode.direction[1], mode.direction[2]};
    const double w = mode.natural_frequency, zeta = mode.damping_ratio;
    if (!(w > 0.0) || !(mode.stiffness > 0.0) || !(zeta >= 0.0 && zeta < 1.0) || !(direction.norm() > 0.0))
      throw std::invalid_argument("a mode needs frequency > 0, stiffness > 0, 0 <= damping < 1 and a direction");
    const double damped = w * std::sqrt(1.0 - zeta * zeta);
    const double decay = std::exp(-zeta * w * step), s = std::sin(damped * step) / damped, c = std::cos(damped * step);
    modes_.push_back({.direction = direction.normalized(),
                      .frequency = w,
                      .damping_ratio = zeta,
                      .mass = mode.stiffness / (w * w),
                      .free_qq = decay * (c + zeta * w * s),
                      .free_qv = decay * s,
                      .free_vq = -decay * w * w * s,
                      .free_vv = decay * (c - zeta * w * s)});
  }
}

void ModalStructure::set_modes(std::span<const Mode> modes) {
  if (modes.size() != modes_.size()) throw std::invalid_argument("a structure keeps its number of modes");
  ModalStructure other(modes, step_);
  for (std::size_t i = 0; i < modes_.size(); ++i) {
    other.modes_[i].q = modes_[i].q;
    other.modes_[i].v = modes_[i].v;
    other.modes_[i].drive = modes_[i].drive * modes_[i].mass / other.modes_[i].mass;  // the same force
  }
  modes_ = std::move(other.modes_);
}

void ModalStructure::strike(const Eigen::Vector3d& impulse) {
  for (Oscillator& mode : modes_) mode.v += mode.direction.dot(impulse) / mode.mass;
}

// The response to a force along a straight line is itself a straight line, rest + drift t, plus free vibration about
// it.
ModalStructure::Motion ModalStructure::after_step(const Oscillator& mode, double drive_begin, double drive_end) const {
  const double w = mode.frequency;
  const double drift = (drive_end - drive_begin) / (step_ * w * w);
  const double rest = drive_begin / (w * w) - 2.0 * mode.damping_ratio * drift / w;
  const double q = mode.q - rest, v = mode.v - drift;
  return {mode.free_qq * q + mode.free_qv * v + rest + drift * step_, mode.free_vq * q + mode.free_vv * v + drift};
}

Eigen::Vector3d ModalStructure::displacement_after(const Eigen::Vector3d& begin, const Eigen::Vector3d& end) const {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Oscillator& mode : modes_) {
    const double begin_drive = mode.direction.dot(begin) / mode.mass, end_drive = mode.direction.dot(end) / mode.mass;
    sum += mode.direction * after_step(mode, begin_drive, end_drive).q;
  }
  return sum;
}

void ModalStructure::advance(const Eigen::Vector3d& begin, const Eigen::Vector3d& end) {
  for (Oscillator& mode : modes_) {
    mode.drive = mode.direction.dot(end) / mode.mass;
    const Motion next = after_step(mode, mode.direction.dot(begin) / mode.mass, mode.drive);
    mode.q = next.q;
    mode.v = next.v;
  }
}

Eigen::Vector3d ModalStructure::displacement() const {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Oscillator& mode : modes_) sum += mode.direction * mode.q;
  return sum;
}

Eigen::Vector3d ModalStructure::velocity() const {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Oscillator& mode : modes_) sum += mode.direction * mode.v;
  return sum;
}

Eigen::Vector3d ModalStructure::acceleration() const {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Oscillator& mode : modes_) {
    const double w = mode.frequency;
    sum += mode.direction * (mode.drive - 2.0 * mode.damping_ratio * w * mode.v - w * w * mode.q);
  }
  return sum;
}

std::vector<ModalMotion> ModalStructure::motion() const {
  std::vector<ModalMotion> motion;
  for (const Oscillator& mode : modes_) motion.push_back({mode.q, mode.v});
  return motion;
}

void ModalStructure::set_motion(std::span<const ModalMotion> motion) {
  if (motion.size() != modes_.size()) throw std::invalid_argument("the motion has another number of modes");
  for (std::size_t i = 0; i < modes_.size(); ++i) {
    modes_[i].q = motion[i].displacement;
    modes_[i].v = motion[i].velocity;
  }
}

double ModalStructure::energy() const {
  double sum = 0.0;
  for (const Oscillator& mode : modes_)
    sum += 0.5 * mode.mass * (mode.v * mode.v + mode.frequency * mode.frequency * mode.q * mode.q);
  return sum;
}

}  // namespace stillcut
