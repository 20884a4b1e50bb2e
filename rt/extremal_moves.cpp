#include "rt/extremal_moves.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace stillcut {

FarthestMoves farthest_moves(const AxisMove& move, double side) noexcept {
  constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
  FarthestMoves f;
  f.side = side;
  f.a0 = side * move.a0;
  f.af = side * move.af;
  const double v0 = side * move.v0, vf = side * move.vf;
  const double a0_squared = f.a0 * f.a0, af_squared = f.af * f.af;
  f.w0 = v0 - a0_squared / 2;
  f.wf = vf - af_squared / 2;
  f.c = (vf - v0) + (f.a0 - f.af) * (f.a0 + f.af) / 2;
  f.sigma = f.w0 + f.wf;
  const double gap_rounding = 8 * kEpsilon * (std::abs(v0) + std::abs(vf) + a0_squared + af_squared);
  f.velocity_rounding = 2 * kEpsilon * (std::abs(v0) + std::abs(vf));
  // Carrying the ends to the instants without acceleration: a ramp from 0 to a covers w a + a^3/6. The difference of
  // the two, a0 w0 + a0^3/6 - af wf - af^3/6, is formed from differences, which are small where the ends are alike.
  const double fall = f.a0 - f.af, mean = (f.a0 + f.af) / 2, squares = a0_squared + f.a0 * f.af + af_squared;
  f.distance = side * move.distance + fall * (f.sigma / 2 + squares / 6) - mean * f.c;
  f.distance_rounding = move.distance_rounding +
                        8 * kEpsilon * (std::abs(fall) * (std::abs(f.sigma) + squares) + std::abs(mean * f.c)) +
                        std::abs(mean) * f.velocity_rounding;
  const bool up = side > 0;
  f.m = up ? move.amax : -move.amin;
  f.n = up ? -move.amin : move.amax;
  f.v = up ? move.vmax : -move.vmin;
  f.gain0 = (f.v - v0) + a0_squared / 2;
  f.gainf = (f.v - vf) + af_squared / 2;
  // Where a plain ramp between accelerations of one sign closes the gap in velocity but for rounding, it closes it;
  // otherwise a move planned again on such a ramp would make a detour.
  const bool one_sign = f.a0 * f.af >= 0;
  if (one_sign && f.af >= f.a0 && std::abs(f.c) <= gap_rounding) {
    f.c = 0.0;
    f.reversed = f.a0 < 0;
  } else {
    f.reversed = f.c < 0;
  }
  if (f.reversed) {
    std::swap(f.w0, f.wf);
    std::swap(f.gain0, f.gainf);
    std::swap(f.m, f.n);
    f.a0 = -std::exchange(f.af, -f.a0);
    f.c = -f.c;
  }
  if (one_sign && f.a0 > f.af && f.af >= 0) {
    const double plain = (f.a0 - f.af) * (f.a0 + f.af);
    if (std::abs(f.c - plain) <= gap_rounding) f.c = plain;
  }
  return f;
}

ExtremalMove in_order(const FarthestMoves& family, ExtremalMove move) noexcept {
  move.side = family.side;
  move.rise = move.peak - family.a0;
  move.fall = move.peak - move.trough;
  move.settle = family.af - move.trough;
  if (family.reversed) {
    std::swap(move.rise, move.settle);
    move.peak = -std::exchange(move.trough, -move.peak);
    std::swap(move.peak_hold, move.trough_hold);
  }
  return move;
}

// With the hold from c = m^2 - B^2 + m h, a polynomial of B; its derivative is (wf + B^2 - m B/2)(2 B/m - 2).
double distance_peak_held(const FarthestMoves& f, double b) noexcept {
  return (b * b * (b * b + 2 * f.wf + f.m * f.m - 2 * f.m * b) - 4 * f.m * f.wf * b + f.sigma * (f.m * f.m + f.c)) /
         (2 * f.m);
}

// With the hold as the unknown: c may be large beside n h = A^2 - n^2 - c. Its derivative is (w0 + A^2 + n A/2)(1 +
// n/A).
double distance_trough_held(const FarthestMoves& f, double a, double hold) noexcept {
  const double end = f.wf + f.n * f.n / 2;  // the speed at which the hold ends
  return f.n * end + hold * (end + f.n * hold / 2) + (end + f.n * hold) * (f.n + a) + a * (f.w0 + f.n * f.n / 2);
}

ChangeOfSpeed change_of_speed(double gain, double limit, double least) noexcept {
  if (gain > limit * limit) return {limit, (gain - limit * limit) / limit};
  return {std::max({std::sqrt(std::max(gain, 0.0)), least, 0.0}), 0.0};
}

}  // namespace stillcut
