#include "rt/brake.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace stillcut {
namespace {

// Slowing down (jerk -1), in quantities mirrored so that the start is too fast: until the speed is back at its upper
// limit, but not beyond the last instant at which the lower limit can still be kept.
Brake slow_down(double v0, double a0, double vmax, double vmin, double amin) noexcept {
  const double at_limit = -std::sqrt(std::max(0.0, a0 * a0 + 2 * (v0 - vmax)));
  const double at_last = -std::sqrt(std::max(0.0, a0 * a0 / 2 + v0 - vmin));  // there v - a^2/2 = vmin
  const double reached = std::max(at_limit, at_last);
  if (reached >= amin) return {-1.0, std::max(0.0, a0 - reached), 0.0, std::min(a0, reached)};
  const double v = v0 + (a0 - amin) * (a0 + amin) / 2;
  const double hold = std::min((v - vmax) / -amin, (v - amin * amin / 2 - vmin) / -amin);
  return {-1.0, std::max(0.0, a0 - amin), std::max(0.0, hold), amin};
}

// The start's acceleration is above its limit.
Brake ease(double v0, double a0, double vmax, double vmin, double amax, double amin) noexcept {
  if (v0 + a0 * a0 / 2 > vmax) return slow_down(v0, a0, vmax, vmin, amin);
  const double v = v0 + (a0 - amax) * (a0 + amax) / 2;
  const double hold = std::min((vmin - v) / amax, (vmax - amax * amax / 2 - v) / amax);
  return {-1.0, a0 - amax, std::max(0.0, hold), amax};
}

Brake mirrored(Brake brake) noexcept {
  brake.jerk = -brake.jerk;
  brake.acceleration = -brake.acceleration;
  return brake;
}

}  // namespace

Brake brake_of(const AxisMove& s) noexcept {
  if (s.a0 > s.amax) return ease(s.v0, s.a0, s.vmax, s.vmin, s.amax, s.amin);
  if (s.a0 < s.amin) return mirrored(ease(-s.v0, -s.a0, -s.vmin, -s.vmax, -s.amin, -s.amax));
  // How far beyond each limit the speed must be when the acceleration is back at zero; rounding is none.
  const double ramp = s.a0 * std::abs(s.a0) / 2;
  const double rounding = 16 * std::numeric_limits<double>::epsilon() * (std::abs(s.v0) + std::abs(ramp));
  const double above = (s.v0 - s.vmax) + ramp, below = (s.vmin - s.v0) - ramp;
  if ((s.v0 - s.vmax > rounding && below < 0) || (s.a0 > 0 && above > rounding)) {
    return slow_down(s.v0, s.a0, s.vmax, s.vmin, s.amin);
  }
  if ((s.vmin - s.v0 > rounding && above < 0) || (s.a0 < 0 && below > rounding)) {
    return mirrored(slow_down(-s.v0, -s.a0, -s.vmin, -s.vmax, -s.amax));
  }
  return {};
}

}  // namespace stillcut
