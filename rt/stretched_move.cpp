#include "rt/stretched_move.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace stillcut {
namespace {

// A member of the family, and how much farther it goes than asked.
struct Member {
  ExtremalMove move;
  double excess = 0.0;
};

Member member(const FarthestMoves& f, double peak, double peak_hold, double trough, double trough_hold,
              double distance) noexcept {
  return {{1.0, peak, trough, peak_hold, 0.0, trough_hold}, distance - f.distance};
}

// With both held: the gain from w0 to the speed between the holds follows from the time.
Member both_held(const FarthestMoves& f, double time) noexcept {
  const double gain = std::max(0.0, (time - f.m - f.n + f.c / f.n) / (1 / f.m + 1 / f.n));
  const double to_speed = f.m + gain / f.m, from_speed = f.n + (gain - f.c) / f.n;
  const double distance = ((2 * f.w0 + gain) * to_speed + (f.sigma + gain) * from_speed) / 2;
  return member(f, f.m, std::max(0.0, gain / f.m - f.m), -f.n, std::max(0.0, (gain - f.c) / f.n - f.n), distance);
}

// The member whose two ramps and holds between the instants without acceleration take `time`, without cruise.
Member without_cruise(const FarthestMoves& f, double time) noexcept {
  const double width = time / 2, sum = f.c > 0 ? f.c / width : 0.0;
  const double peak = (sum + width) / 2, trough = (sum - width) / 2;
  if (peak <= f.m && trough >= -f.n) return member(f, peak, 0.0, trough, 0.0, distance_free(f, peak, trough));
  if (peak > f.m) {  // time = 2 m + h - 2 B, with the hold h from c = m^2 - B^2 + m h
    const double b = f.m - std::sqrt(std::max(0.0, f.m * time - f.c)), hold = time - 2 * f.m + 2 * b;
    if (b >= -f.n && hold >= 0) return member(f, f.m, hold, b, 0.0, distance_peak_held(f, b));
  }
  if (trough < -f.n) {  // the same backwards
    const double a = std::sqrt(std::max(0.0, f.c + f.n * time)) - f.n, hold = time - 2 * f.n - 2 * a;
    if (a <= f.m && hold >= 0) return member(f, a, 0.0, -f.n, hold, distance_trough_held(f, a, hold));
  }
  return both_held(f, time);
}

// The farthest move of this duration; nothing where the change of speed alone cannot be made in it.
std::optional<Member> member_of_duration(const FarthestMoves& f, double duration) noexcept {
  const double time = duration - (f.af - f.a0);
  if (!(time >= 0)) return std::nullopt;
  const ChangeOfSpeed first = change_of_speed(f.gain0, f.m, f.a0), second = change_of_speed(f.gainf, f.n, -f.af);
  const double cruise = time - first.duration() - second.duration();
  if (cruise >= 0) {
    const double distance = ((f.w0 + f.v) * first.duration() + (f.v + f.wf) * second.duration()) / 2 + cruise * f.v;
    Member found = member(f, first.peak, first.hold, -second.peak, second.hold, distance);
    found.move.cruise = cruise;
    return found;
  }
  const Member found = without_cruise(f, time);
  // Rounding of the time moves peak and trough by as much.
  const double rounding = 8 * std::numeric_limits<double>::epsilon() * (duration + std::abs(f.a0) + std::abs(f.af));
  if (found.move.peak < f.a0 - rounding || found.move.trough > f.af + rounding) return std::nullopt;
  return found;
}

// What rounding may do to a distance covered in this time.
double distance_rounding(const FarthestMoves& f, double duration) noexcept {
  const double speed = std::abs(f.w0) + std::abs(f.wf) + f.m * std::min(duration, f.m);
  return f.distance_rounding + 16 * std::numeric_limits<double>::epsilon() * speed * duration;
}

// Duration at the end of the moves that keep the acceleration above zero, and of the shortest that dips below it.
struct Gap {
  double begin = 0.0, end = 0.0;
};
std::optional<Gap> gap_of(const FarthestMoves& f) noexcept {
  const double depth_squared = f.a0 * f.a0 - f.c;
  if (!(f.a0 > 0 && f.af > 0 && depth_squared > 0 && depth_squared <= f.af * f.af)) return std::nullopt;
  const double depth = std::sqrt(depth_squared);
  const double trough = std::min(depth, f.n), hold = (depth_squared - trough * trough) / f.n;
  return Gap{f.a0 + f.af - 2 * depth, f.a0 + f.af + 2 * trough + hold};
}

bool reaches(const FarthestMoves& f, double duration) noexcept {
  const auto found = member_of_duration(f, duration);
  return found && found->excess >= 0;
}

// From a duration whose farthest move falls short: the first that reaches. Bisection, as the reach grows from there.
double first_reaching(const FarthestMoves& f, double duration) noexcept {
  double low = duration, high = duration;
  const auto gap = gap_of(f);
  if (gap && low < gap->end) {
    if (low < gap->begin && reaches(f, gap->begin)) {
      high = gap->begin;
    } else {
      low = gap->end;
      if (reaches(f, low)) return low;
    }
  }
  if (high <= low) {
    double step = std::max({low, f.m, f.n}) / 8;
    high = low + step;
    for (int i = 0; i < 2000 && !reaches(f, high); ++i) {
      low = high;
      high += step *= 2;
    }
  }
  for (int i = 0; i < 200; ++i) {
    const double middle = (low + high) / 2;
    if (middle <= low || middle >= high) break;
    (reaches(f, middle) ? high : low) = middle;
  }
  return high;
}

}  // namespace

std::optional<StretchedMove> move_of_duration(const AxisMove& move, double duration) noexcept {
  const FarthestMoves up = farthest_moves(move, 1.0), down = farthest_moves(move, -1.0);
  const auto farthest = member_of_duration(up, duration), least = member_of_duration(down, duration);
  if (!farthest || !least) return std::nullopt;
  const double slack = distance_rounding(up, duration);
  if (farthest->excess < -slack || least->excess < -slack) return std::nullopt;
  const double above = std::max(farthest->excess, 0.0), below = std::max(least->excess, 0.0);
  return StretchedMove{in_order(up, farthest->move), in_order(down, least->move),
                       above + below > 0 ? below / (above + below) : 1.0};
}

double next_possible_duration(const AxisMove& move, double duration) noexcept {
  const FarthestMoves up = farthest_moves(move, 1.0), down = farthest_moves(move, -1.0);
  const auto farthest = member_of_duration(up, duration), least = member_of_duration(down, duration);
  if (farthest && farthest->excess < 0 && !(least && least->excess < farthest->excess)) {
    return first_reaching(up, duration);
  }
  if (least && least->excess < 0) return first_reaching(down, duration);
  // Inside the gap where the change of speed cannot be made: to its end, where both families begin with one move.
  const auto gap = gap_of(up);
  if (!gap || duration >= gap->end) return std::nextafter(duration, std::numeric_limits<double>::infinity());
  const auto first = member_of_duration(up, gap->end);
  if (first && first->excess < 0) return first_reaching(up, gap->end);
  const auto mirrored = member_of_duration(down, gap->end);
  if (mirrored && mirrored->excess < 0) return first_reaching(down, gap->end);
  return gap->end;
}

}  // namespace stillcut
