#include "models/receptance.hpp"

#include <cmath>
#include <complex>
#include <stdexcept>
#include <string>

namespace stillcut {

void check_modes(std::span<const Mode> modes) {
  if (modes.empty()) throw std::invalid_argument("modes: there are none; a posture needs at least one mode");
  for (std::size_t i = 0; i < modes.size(); ++i) {
    const Mode& mode = modes[i];
    const auto refuse = [i](const char* what) {
      throw std::invalid_argument("mode " + std::to_string(i + 1) + ": " + what);
    };
    if (!(mode.natural_frequency > 0.0) || !std::isfinite(mode.natural_frequency)) {
      refuse("frequency must be positive");
    }
    if (!(mode.damping_ratio > 0.0 && mode.damping_ratio < 1.0)) refuse("damping ratio must lie between 0 and 1");
    if (!(mode.stiffness > 0.0) || !std::isfinite(mode.stiffness)) refuse("stiffness must be positive");
    const auto& u = mode.direction;
    const double length = std::hypot(u[0], u[1], u[2]);
    if (!(length > 1e-9) || !std::isfinite(length)) refuse("direction must not be zero");
  }
}

Eigen::Matrix3cd receptance(std::span<const Mode> modes, double frequency) {
  Eigen::Matrix3cd sum = Eigen::Matrix3cd::Zero();
  for (const Mode& mode : modes) {
    const double ratio = frequency / mode.natural_frequency;
    const std::complex<double> dynamic_stiffness =
        mode.stiffness * std::complex<double>(1.0 - ratio * ratio, 2.0 * mode.damping_ratio * ratio);
    const Eigen::Vector3d u(mode.direction.data());
    sum += (u * u.transpose()).cast<std::complex<double>>() / dynamic_stiffness;
  }
  return sum;
}

std::vector<Mode> modes_in_feed_frame(std::span<const Mode> modes, double feed_direction) {
  const double c = std::cos(feed_direction), s = std::sin(feed_direction);
  std::vector<Mode> turned(modes.begin(), modes.end());
  for (Mode& mode : turned) {
    const auto [x, y, z] = mode.direction;
    mode.direction = {c * x + s * y, -s * x + c * y, z};
  }
  return turned;
}

}  // namespace stillcut
