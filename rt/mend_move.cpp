// Where a move is much shorter than the time it would take to build up its acceleration, the instants without
// acceleration lie far outside it, and distances reckoned from them cancel. Its own durations then are refined.
#include <algorithm>
#include <cmath>

#include "rt/extremal_moves.hpp"

namespace stillcut {
namespace {

// A move without cruise, mirrored by its side: rise, hold of the peak, fall, hold of the trough, settling.
struct Durations {
  double rise = 0.0, peak_hold = 0.0, trough_hold = 0.0, settle = 0.0;
};

// How much velocity and distance differ from what is asked, and how that changes with the first of the two free
// durations (rise, or the hold of the peak) and with the second (settling, or the hold of the trough).
struct Misses {
  double velocity = 0.0, distance = 0.0;
  double velocity_first = 0.0, velocity_second = 0.0, distance_first = 0.0, distance_second = 0.0;
};

struct Condition {
  double p = 0.0, v = 0.0;
};
void advance(Condition& s, double a, double jerk, double t) noexcept {
  s.p += t * (s.v + t * (a / 2 + t * jerk / 6));
  s.v += t * (a + t * jerk / 2);
}

Misses misses_of(const AxisMove& move, double side, const Durations& t) noexcept {
  const double a0 = side * move.a0, af = side * move.af, v0 = side * move.v0;
  const double fall = t.rise + t.settle + (a0 - af), peak = a0 + t.rise, trough = af - t.settle;
  Condition s;  // velocity above v0
  advance(s, a0, 1.0, t.rise);
  const double after_rise = v0 + s.v;
  advance(s, peak, 0.0, t.peak_hold);
  const double after_hold = v0 + s.v;
  advance(s, peak, -1.0, fall);
  const double after_fall = v0 + s.v;
  advance(s, trough, 0.0, t.trough_hold);
  const double after_trough = v0 + s.v;
  advance(s, trough, 1.0, t.settle);
  const double duration = t.rise + t.peak_hold + fall + t.trough_hold + t.settle;
  Misses m;
  m.velocity = s.v - side * (move.vf - move.v0);
  m.distance = s.p + v0 * duration - side * move.distance;
  if (t.peak_hold > 0) {
    m.velocity_first = peak;
    m.distance_first = after_hold + peak * (fall + t.trough_hold + t.settle);
  } else {
    m.velocity_first = 2 * peak;
    m.distance_first = after_rise + after_fall + fall * (peak + fall / 2) + 2 * peak * (t.trough_hold + t.settle);
  }
  if (t.trough_hold > 0) {
    m.velocity_second = trough;
    m.distance_second = after_trough + trough * t.settle;
  } else {
    m.velocity_second = 2 * trough;
    m.distance_second = after_fall + v0 + s.v + t.settle * (trough - t.settle / 2);
  }
  return m;
}

}  // namespace

ExtremalMove mend(const AxisMove& move, const ExtremalMove& found) noexcept {
  if (found.cruise > 0 || (found.peak_hold > 0 && found.trough_hold > 0)) return found;
  const double side = found.side, a0 = side * move.a0, af = side * move.af;
  Durations best{found.rise, found.peak_hold, found.trough_hold, found.settle};
  Misses miss = misses_of(move, side, best);
  const double duration = found.duration();
  const auto size = [&](const Misses& m) { return std::abs(m.velocity) * duration + std::abs(m.distance); };
  // Near a double root the steps only halve the way, and not each is better by itself.
  constexpr int kMostSteps = 12;
  Durations at = best;
  double least = size(miss);
  for (int i = 0; i < kMostSteps && least > 0; ++i) {
    const double determinant = miss.velocity_first * miss.distance_second - miss.velocity_second * miss.distance_first;
    if (determinant == 0) break;
    const double first = (miss.velocity * miss.distance_second - miss.distance * miss.velocity_second) / determinant;
    const double second = (miss.velocity_first * miss.distance - miss.distance_first * miss.velocity) / determinant;
    (at.peak_hold > 0 ? at.peak_hold : at.rise) -= first;
    (at.trough_hold > 0 ? at.trough_hold : at.settle) -= second;
    if (!(std::min({at.rise, at.peak_hold, at.trough_hold, at.settle, at.rise + at.settle + (a0 - af)}) >= 0)) break;
    miss = misses_of(move, side, at);
    if (size(miss) < least) {
      best = at;
      least = size(miss);
    } else if (i > 2) {
      break;
    }
  }
  ExtremalMove mended = found;
  mended.rise = best.rise;
  mended.peak_hold = best.peak_hold;
  mended.trough_hold = best.trough_hold;
  mended.settle = best.settle;
  mended.fall = best.rise + best.settle + (a0 - af);
  mended.peak = a0 + best.rise;
  mended.trough = af - best.settle;
  return mended;
}

double excess_of(const AxisMove& move, const ExtremalMove& found) noexcept {
  return misses_of(move, found.side, {found.rise, found.peak_hold, found.trough_hold, found.settle}).distance;
}

}  // namespace stillcut
