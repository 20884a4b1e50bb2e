#include "rt/velocity_change.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace stillcut {
namespace {

struct Bulge {
  double b0 = 0.0, bf = 0.0, limit = 0.0, gain = 0.0;  // mirrored by the side
};

Bulge bulge_of(const AxisMove& move, double side) noexcept {
  return {side * move.a0, side * move.af, side > 0 ? move.amax : -move.amin, side * (move.vf - move.v0)};
}

ExtremalMove as_move(const Bulge& b, double side, double peak, double hold) noexcept {
  return {side, peak, b.bf, hold, 0.0, 0.0, peak - b.b0, peak - b.bf, 0.0};
}

// The largest gain in this time and how much it exceeds what is asked: A^2 - (b0^2 + bf^2)/2 + m h.
struct Largest {
  ExtremalMove move;
  double excess = 0.0;
};
Largest largest(const AxisMove& move, double side, double duration) noexcept {
  const Bulge b = bulge_of(move, side);
  const double free_peak = std::max({(duration + b.b0 + b.bf) / 2, b.b0, b.bf});
  const double peak = std::min(free_peak, b.limit), hold = 2 * (free_peak - peak);
  const double gain = peak * peak - (b.b0 * b.b0 + b.bf * b.bf) / 2 + peak * hold;
  return {as_move(b, side, peak, hold), gain - b.gain};
}

}  // namespace

ExtremalMove fastest_change(const AxisMove& move) noexcept {
  const double gain = move.vf - move.v0, a0 = move.a0, af = move.af;
  double gap = gain - (a0 + af) / 2 * std::abs(af - a0);
  // As in plan_velocity: a gap within rounding is none where it would cost a detour.
  const double rounding = 4 * std::numeric_limits<double>::epsilon() *
                          (std::abs(move.v0) + std::abs(move.vf) + (a0 == af ? 0.0 : a0 * a0 + af * af));
  if (a0 * af > 0 && gap * a0 < 0 && std::abs(gap) <= rounding) gap = 0.0;
  const double side = std::copysign(1.0, gap);
  const Bulge b = bulge_of(move, side);
  const double high = std::max(b.b0, b.bf), missing = std::abs(gap);
  const double peak = std::max(std::sqrt(missing + high * high), high);
  if (missing == 0.0) return as_move(b, side, high, 0.0);
  if (peak <= b.limit) return as_move(b, side, peak, 0.0);
  return as_move(b, side, b.limit, std::max(0.0, (missing - (b.limit - high) * (b.limit + high)) / b.limit));
}

// Between the extremes lies every plateau p of the acceleration: the gain grows with it at the rate of its hold.
// Between a0 and af it is ramp + p (T - |af - a0|); above both, -p^2 + p (T + a0 + af) - (a0^2 + af^2)/2; below, the
// mirror image.
std::optional<StretchedMove> change_of_duration(const AxisMove& move, double duration) noexcept {
  const Largest up = largest(move, 1.0, duration), down = largest(move, -1.0, duration);
  const double slack = 16 * std::numeric_limits<double>::epsilon() *
                       (std::abs(move.v0) + std::abs(move.vf) + move.a0 * move.a0 + move.af * move.af);
  if (up.excess < -slack || down.excess < -slack) return std::nullopt;
  const double ramp_time = std::abs(move.af - move.a0), free_time = duration - ramp_time;
  const double rest = (move.vf - move.v0) - (move.a0 + move.af) / 2 * ramp_time;
  const double level = free_time > 0 ? rest / free_time : move.a0;
  const double side =
      level > std::max(move.a0, move.af) || (level >= std::min(move.a0, move.af) && move.af >= move.a0) ? 1 : -1;
  const Bulge b = bulge_of(move, side);
  const double low = std::min(b.b0, b.bf), high = std::max(b.b0, b.bf);
  double plateau = std::clamp(side * level, low, high);
  if (side * level > high) {
    const double q = (duration + b.b0 + b.bf) / 2, squared = b.gain + (b.b0 * b.b0 + b.bf * b.bf) / 2;
    plateau = std::clamp(squared / (q + std::sqrt(std::max(0.0, q * q - squared))), high, std::max(high, b.limit));
  }
  const double hold = std::max(0.0, duration - std::abs(plateau - b.b0) - std::abs(plateau - b.bf));
  const double trough = std::min(plateau, b.bf);
  const ExtremalMove found{side, plateau, trough, hold, 0.0, 0.0, plateau - b.b0, plateau - trough, b.bf - trough};
  return StretchedMove{found, found, 1.0};
}

double next_possible_change(const AxisMove& move, double duration) noexcept {
  const double side = largest(move, 1.0, duration).excess < 0 ? 1.0 : -1.0;
  const Bulge b = bulge_of(move, side);
  const double squared = std::max(0.0, b.gain + (b.b0 * b.b0 + b.bf * b.bf) / 2), peak = std::sqrt(squared);
  if (peak <= b.limit) return 2 * peak - b.b0 - b.bf;
  return 2 * b.limit - b.b0 - b.bf + (squared - b.limit * b.limit) / b.limit;
}

}  // namespace stillcut
