// Which member of the family of extremal moves covers the distance asked: the component of the family, the piece of it
// (what is held), then the root of its polynomial.
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "rt/extremal_moves.hpp"
#include "rt/extremal_roots.hpp"

namespace stillcut {
namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

// Where a component of the family begins: with the shortest move there.
struct FirstMember {
  double peak = 0.0, trough = 0.0;
  double following = 0.0;  // the one of them that follows from c, so that rounding of c moves it; its size
  bool trough_held = false;
  double hold = 0.0;  // of the trough
  double distance = 0.0;
};

// The first (shortest) member that goes at least as far as `distance`, where the members from `start` on pass that
// distance exactly once. The last of them end in the cruise.
ExtremalMove root_from(const FarthestMoves& f, const FirstMember& start, double distance) noexcept {
  const ChangeOfSpeed first = change_of_speed(f.gain0, f.m, f.a0), second = change_of_speed(f.gainf, f.n, -f.af);
  const double to_cruise = ((f.w0 + f.v) * first.duration() + (f.v + f.wf) * second.duration()) / 2;
  if (distance >= to_cruise) {
    return {1.0, first.peak, -second.peak, first.hold, (distance - to_cruise) / f.v, second.hold};
  }
  const double m = f.m, n = f.n;
  double b = start.trough, peak_free = start.peak;
  bool trough_held = start.trough_held;
  if (!trough_held && f.c < m * m) {
    const double s = std::sqrt(m * m - f.c);  // the peak is free for |B| < s
    if (b > s) {
      if (distance <= distance_free(f, m, s)) return root_peak_held(f, distance, b, s);
      b = s;
      peak_free = m;
    }
    if (b > -std::min(s, n)) {
      const bool peak_first = s <= n;
      const double a_end = peak_first ? m : std::sqrt(n * n + f.c), b_end = peak_first ? -s : -n;
      if (distance <= distance_free(f, a_end, b_end)) {
        const double width = b > 0 ? f.c / (peak_free + b) : peak_free - b;
        return root_free(f, distance, width, a_end - b_end);
      }
      b = b_end;
      peak_free = a_end;
    }
    trough_held = s > n;
  }
  if (trough_held) {
    const double longest = std::max(start.hold, (m * m - n * n - f.c) / n);
    if (distance <= distance_trough_held(f, m, longest)) return root_trough_held(f, distance, start.hold, longest);
  } else if (distance <= distance_peak_held(f, -n)) {
    return root_peak_held(f, distance, b, -n);
  }
  return root_both_held(f, distance);
}

// Begins with a bulge: no trough below the target's acceleration.
FirstMember bulge_start(const FarthestMoves& f) noexcept {
  FirstMember start;
  start.trough = f.af;
  const double peak_squared = f.af * f.af + f.c;
  if (peak_squared <= f.m * f.m) {
    start.peak = std::max(std::sqrt(std::max(0.0, peak_squared)), f.a0);
    start.distance = distance_free(f, start.peak, f.af);
  } else {
    start.peak = f.m;
    start.distance = distance_peak_held(f, f.af);
  }
  start.following = start.peak;
  return start;
}

// Begins with a dip below zero: no peak above the first acceleration, a0 > 0, a0^2 > c.
FirstMember dip_start(const FarthestMoves& f) noexcept {
  FirstMember start;
  start.peak = f.a0;
  const double depth = std::sqrt(std::max(0.0, f.a0 * f.a0 - f.c));
  start.trough_held = depth > f.n;
  start.trough = start.trough_held ? -f.n : -depth;
  start.following = -start.trough;
  if (start.trough_held) {
    start.hold = (depth - f.n) * (depth + f.n) / f.n;
    start.distance = distance_trough_held(f, f.a0, start.hold);
  } else {
    start.distance = distance_free(f, f.a0, -depth);
  }
  return start;
}

enum class Beginning { bulge, dip, island };

// An island: the acceleration stays above zero. Between its longest move and the shortest one that dips below zero lie
// durations in which the change of speed cannot be made at all.
Beginning beginning(const FarthestMoves& f) noexcept {
  if (!(f.a0 > 0 && f.a0 * f.a0 > f.c)) return Beginning::bulge;
  if (f.c < (f.a0 - f.af) * (f.a0 + f.af)) return Beginning::dip;
  return f.af > 0 ? Beginning::island : Beginning::bulge;
}

// The farthest distance is not monotone where the acceleration stays well above zero and the speed is negative: it may
// first rise to a maximum. The trough of that maximum, if it lies between the start's and `end`.
std::optional<double> trough_at_maximum(const FarthestMoves& f, const FirstMember& start, double end) noexcept {
  const double free_below = f.c < f.m * f.m ? std::sqrt(f.m * f.m - f.c) : -f.n;
  const double held = f.m * f.m / 16 - f.wf;
  if (held > 0) {  // wf + B^2 - m B/2 = 0
    const double b = f.m / 4 + std::sqrt(held);
    if (b < start.trough && b > std::max(free_below, end)) return b;
  }
  const double discriminant = 4 * f.sigma * f.sigma - 3 * f.c * f.c;
  if (f.sigma < 0 && discriminant > 0 && f.c > 0) {  // 3 u^4 + 4 sigma u^2 + c^2 = 0, the smaller root
    const double u = f.c / std::sqrt(-2 * f.sigma + std::sqrt(discriminant));
    const double b = (f.c / u - u) / 2;
    if (b < std::min(start.trough, free_below) && b > end) return b;
  }
  return std::nullopt;
}

ExtremalMove start_move(const FarthestMoves& f, const FirstMember& start) noexcept {
  ExtremalMove move;
  move.peak = start.peak;
  move.trough = start.trough;
  if (start.trough_held) {
    move.trough_hold = start.hold;
  } else if (start.peak == f.m) {
    move.peak_hold = std::max(0.0, (f.c - (f.m - start.trough) * (f.m + start.trough)) / f.m);
  }
  return move;
}

// Before that maximum the distance rises: the root there.
ExtremalMove root_before_maximum(const FarthestMoves& f, const FirstMember& start, double distance,
                                 double end) noexcept {
  const double s = f.c < f.m * f.m ? std::sqrt(f.m * f.m - f.c) : -f.n;
  double b = start.trough, a = start.peak;
  if (b > s) {
    const double held_end = std::max(s, end);
    if (end >= s || distance <= distance_peak_held(f, held_end)) return root_peak_held(f, distance, b, held_end);
    b = s;
    a = f.m;
  }
  const double a_end = std::sqrt(end * end + f.c);
  const double low = f.c / (a + b), high = f.c / (a_end + end);
  return low < high ? root_free(f, distance, low, high) : start_move(f, start);
}

// How far rounding of the positions, accelerations and velocities may move the distance of the start (or of the end of
// an island). That of the velocities moves its duration first; more than a trace of the duration is no rounding.
double rounding_at(const FarthestMoves& f, const FirstMember& start) noexcept {
  constexpr double kTrace = 1e-10, kTiny = std::numeric_limits<double>::min();
  const double duration =
      f.af - f.a0 + 2 * (start.peak - start.trough) + f.c / std::max(start.peak, kTiny);  // at least
  const double time = std::min(f.velocity_rounding / std::max(start.following, kTiny), kTrace * duration);
  return f.distance_rounding + std::abs(f.sigma) * time + 16 * kEpsilon * std::abs(start.distance) +
         f.velocity_rounding * duration;
}

// The fastest on a component that begins with `start`, where distance >= start.distance; nothing when it is an island
// (ends at trough `end` > 0) that does not reach so far.
std::optional<ExtremalMove> root_on(const FarthestMoves& f, const FirstMember& start, double distance,
                                    bool island) noexcept {
  const double end = island ? std::sqrt(std::max(0.0, f.a0 * f.a0 - f.c)) : -f.n;
  if (start.trough > 0) {
    if (const auto top = trough_at_maximum(f, start, end)) {
      const double a = std::sqrt(*top * *top + f.c);
      const double highest = a >= f.m ? distance_peak_held(f, *top) : distance_free(f, a, *top);
      if (distance <= highest) return root_before_maximum(f, start, distance, *top);
      if (island && distance <= highest + rounding_at(f, start)) {
        return root_before_maximum(f, start, highest, *top);
      }
    }
  }
  if (!island) return root_from(f, start, distance);
  const FirstMember longest{f.a0, end, end, false, 0.0, distance_free(f, f.a0, end)};
  if (distance <= longest.distance + rounding_at(f, longest)) {
    return root_before_maximum(f, start, std::min(distance, longest.distance), std::min(end, start.trough));
  }
  return std::nullopt;
}

// Where the distance first shrinks as the duration grows (or may soon), one beyond the start's by rounding only would
// cost a detour: then the start itself is the answer. The rate is wf + B^2 - A B/2, the Hamiltonian of the extremal; it
// falls while B > A/4.
bool is_start(const FarthestMoves& f, const FirstMember& start, double distance) noexcept {
  if (std::abs(distance - start.distance) > rounding_at(f, start)) return false;
  const double speed = start.trough_held ? f.w0 + start.peak * start.peak : f.wf + start.trough * start.trough;
  return speed - start.peak * start.trough / 2 < 0 || start.trough > start.peak / 4;
}

// A move in which the acceleration never is zero may be short beside it.
bool is_short(const AxisMove& move, const ExtremalMove& found) noexcept {
  constexpr double kShort = 0.1;
  return found.peak * found.trough > 0 && found.duration() < kShort * (std::abs(move.a0) + std::abs(move.af));
}
ExtremalMove mended(const AxisMove& move, const ExtremalMove& found) noexcept {
  return is_short(move, found) ? mend(move, found) : found;
}

// With which move the family begins.
FirstMember first_member(const AxisMove& move, const FarthestMoves& f, Beginning kind) noexcept {
  FirstMember start = kind == Beginning::dip ? dip_start(f) : bulge_start(f);
  if (start.peak * start.trough > 0) {
    const ExtremalMove shortest = in_order(f, start_move(f, start));
    if (is_short(move, shortest)) start.distance = f.distance + excess_of(move, shortest);
  }
  return start;
}

}  // namespace

std::optional<ExtremalMove> fastest_move_of_one_sign(const AxisMove& move) noexcept {
  for (double side : {1.0, -1.0}) {
    const FarthestMoves f = farthest_moves(move, side);
    if (beginning(f) != Beginning::island) return std::nullopt;
    const FirstMember start = first_member(move, f, Beginning::island);
    if (is_start(f, start, f.distance)) return in_order(f, start_move(f, start));
    if (f.distance < start.distance) continue;
    const auto found = root_on(f, start, f.distance, true);
    return found ? std::optional(mended(move, in_order(f, *found))) : std::nullopt;
  }
  return std::nullopt;
}

ExtremalMove fastest_move(const AxisMove& move) noexcept {
  FarthestMoves f = farthest_moves(move, 1.0);
  Beginning kind = beginning(f);
  FirstMember start = first_member(move, f, kind);
  if (f.distance < start.distance) {  // the same start, mirrored
    f = farthest_moves(move, -1.0);
    kind = beginning(f);
    start = first_member(move, f, kind);
  }
  if (is_start(f, start, f.distance)) return in_order(f, start_move(f, start));
  if (const auto found = root_on(f, start, f.distance, kind == Beginning::island)) {
    return mended(move, in_order(f, *found));
  }
  // Beyond the island: on to the moves that dip below zero.
  start = dip_start(f);
  if (f.distance < start.distance) {
    f = farthest_moves(move, -f.side);
    start = dip_start(f);
  }
  if (is_start(f, start, f.distance)) return in_order(f, start_move(f, start));
  return in_order(f, root_from(f, start, f.distance));
}

}  // namespace stillcut
