// The moves of one axis that go farthest, and those that go least far, in a given time: between them lies everything
// the axis can do in that time.
//
// For fixed speeds and accelerations at both ends, a move of duration T covers any distance between least(T) and
// farthest(T) and none outside: the limits are convex and the equations linear, so moves can be mixed. The fastest move
// over a distance D therefore ends at the first T with least(T) <= D <= farthest(T), and is extremal itself. By
// Pontryagin's principle the farthest move has jerk +, 0, -, 0, +: up to a peak A of the acceleration, perhaps held at
// its limit m, down to a trough B, perhaps held at its limit -n, up to the target's; where the speed reaches its limit
// V it cruises there, without acceleration, between peak and trough. The least far move is its mirror image.
//
// Everything here is divided by the jerk limit, so that the jerk is 1, 0 or -1: accelerations are in s, velocities in
// s^2, distances in s^3. Pure functions, noexcept, allocate nothing.
#pragma once

#include <optional>

namespace stillcut {

// What is asked of one axis.
struct AxisMove {
  double v0 = 0.0, a0 = 0.0, vf = 0.0, af = 0.0;
  double distance = 0.0;
  double distance_rounding = 0.0;  // how wrong `distance` may be for the rounding of the positions
  double vmax = 0.0, vmin = 0.0;   // vmin < 0 < vmax
  double amax = 0.0, amin = 0.0;   // amin < 0 < amax
};

// An extremal move: ramp from a0 to the peak, hold, ramp to the trough with a cruise where it passes zero, hold, ramp
// to af. The accelerations are those of the axis mirrored by `side`.
struct ExtremalMove {
  double side = 1.0;  // 1: the farthest; -1: the least far
  double peak = 0.0, trough = 0.0;
  double peak_hold = 0.0, cruise = 0.0, trough_hold = 0.0;  // s
  // Of the first ramp, of that from peak to trough (or the two beside the cruise), of the last; s.
  double rise = 0.0, fall = 0.0, settle = 0.0;

  [[nodiscard]] double duration() const noexcept { return rise + peak_hold + fall + cruise + trough_hold + settle; }
};

// The family of farthest moves with these ends, in a normal form. The ends are carried back (and on) along the jerk
// +1 to the instant without acceleration: w = v - a^2/2. Then c = wf - w0 = A^2 - B^2 while nothing is held. Where
// c < 0 the move is looked at backwards in time and mirrored, which swaps A and -B, so that c >= 0 holds below.
struct FarthestMoves {
  double w0 = 0.0, wf = 0.0, c = 0.0, sigma = 0.0;  // sigma = w0 + wf
  double a0 = 0.0, af = 0.0;
  double m = 0.0, n = 0.0, v = 0.0;  // peak <= m, trough >= -n, speed <= v
  double gain0 = 0.0, gainf = 0.0;   // v - w0 and v - wf, s^2
  double distance = 0.0;             // of the move between the two instants without acceleration
  double distance_rounding = 0.0, velocity_rounding = 0.0;
  double side = 1.0;
  bool reversed = false;
};

// The farthest moves for side 1, the least far (in mirrored quantities) for side -1.
[[nodiscard]] FarthestMoves farthest_moves(const AxisMove& move, double side) noexcept;

// The same in the axis's own order of time.
[[nodiscard]] ExtremalMove in_order(const FarthestMoves& family, ExtremalMove move) noexcept;

// Distance of a member of the family whose trough is B and whose peak is held (or only just reaches m) ...
[[nodiscard]] double distance_peak_held(const FarthestMoves& family, double trough) noexcept;
// ... whose peak is A = sqrt(c + n^2 + n h) and whose trough is held for h ...
[[nodiscard]] double distance_trough_held(const FarthestMoves& family, double peak, double hold) noexcept;
// ... whose peak and trough are free: (A - B)(sigma - A B).
[[nodiscard]] inline double distance_free(const FarthestMoves& family, double peak, double trough) noexcept {
  const double width = trough > 0.0 ? family.c / (peak + trough) : peak - trough;
  return width * (family.sigma - peak * trough);
}

// The part of a move between w and the cruising speed, or back: a trapeze of acceleration, at most `limit` high and
// `least` at least, which is what the ends ask for where `gain` is only rounding.
struct ChangeOfSpeed {
  double peak = 0.0, hold = 0.0;
  [[nodiscard]] double duration() const noexcept { return 2.0 * peak + hold; }
};
[[nodiscard]] ChangeOfSpeed change_of_speed(double gain, double limit, double least) noexcept;

// The fastest move over the distance asked. The ends must be inside the limits, and be able to stay inside (before and
// after).
[[nodiscard]] ExtremalMove fastest_move(const AxisMove& move) noexcept;

// The fastest move whose acceleration keeps the sign it has at both ends, if there is one: it passes no speed that is
// not between those of the ends.
[[nodiscard]] std::optional<ExtremalMove> fastest_move_of_one_sign(const AxisMove& move) noexcept;

// Mends, where the whole move is short beside a0 and af, what carrying the ends to the instants without acceleration
// has cost in precision: Newton steps on the equations of the move itself.
[[nodiscard]] ExtremalMove mend(const AxisMove& move, const ExtremalMove& found) noexcept;
// How much farther than asked such a move (without cruise) goes, mirrored by its side, without that loss.
[[nodiscard]] double excess_of(const AxisMove& move, const ExtremalMove& found) noexcept;

}  // namespace stillcut
