#include "rt/synchronized_motion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "rt/stretched_move.hpp"
#include "rt/velocity_change.hpp"

namespace stillcut {
namespace {

struct JerkPhase {
  double duration = 0.0, jerk = 0.0, acceleration_at_end = 0.0;
};

// Phases per unit jerk, in the axis's own signs: seven of an extremal move, or those of a mixture of two.
struct JerkPhases {
  std::array<JerkPhase, 15> phases{};
  std::size_t count = 0;

  void add(double duration, double jerk, double acceleration_at_end) noexcept {
    if (duration > 0 && count + 1 < phases.size()) phases[count++] = {duration, jerk, acceleration_at_end};
  }
  [[nodiscard]] double duration() const noexcept {
    double sum = 0.0;
    for (std::size_t i = 0; i < count; ++i) sum += phases[i].duration;
    return sum;
  }
  [[nodiscard]] std::size_t longest() const noexcept {
    const auto shorter = [](const JerkPhase& a, const JerkPhase& b) { return a.duration < b.duration; };
    return static_cast<std::size_t>(std::max_element(phases.begin(), phases.begin() + count, shorter) - phases.begin());
  }
};

JerkPhases phases_of(const ExtremalMove& move, double af) noexcept {
  JerkPhases p;
  const double s = move.side;
  p.add(move.rise, s, s * move.peak);
  p.add(move.peak_hold, 0.0, s * move.peak);
  p.add(move.cruise > 0 ? move.peak : move.fall, -s, move.cruise > 0 ? 0.0 : s * move.trough);
  p.add(move.cruise, 0.0, 0.0);
  p.add(move.cruise > 0 ? -move.trough : 0.0, -s, s * move.trough);
  p.add(move.trough_hold, 0.0, s * move.trough);
  p.add(move.settle, s, af);
  return p;
}

// Looked at from the end: the acceleration at a phase's end is then that at its start.
JerkPhases backwards(const JerkPhases& forwards, double a0) noexcept {
  JerkPhases p;
  for (std::size_t i = forwards.count; i-- > 0;) {
    const JerkPhase& phase = forwards.phases[i];
    p.add(phase.duration, -phase.jerk, i > 0 ? forwards.phases[i - 1].acceleration_at_end : a0);
  }
  return p;
}

// share * x + (1 - share) * y from acceleration `a` on, as far as the x_end-th phase of x and the y_end-th of y begin.
JerkPhases mixture(const JerkPhases& x, std::size_t x_end, const JerkPhases& y, std::size_t y_end, double share,
                   double a) noexcept {
  JerkPhases mixed;
  std::size_t i = 0, k = 0;
  double x_left = x.phases[0].duration, y_left = y.phases[0].duration, ax = a, ay = a;
  while (i < x_end || k < y_end) {
    const JerkPhase &in_x = x.phases[i], &in_y = y.phases[k];
    const bool x_ends = i < x_end && (k >= y_end || x_left <= y_left);
    const bool y_ends = k < y_end && (i >= x_end || y_left <= x_left);
    const double step = x_ends ? x_left : y_left;
    ax = x_ends ? in_x.acceleration_at_end : ax + in_x.jerk * step;
    ay = y_ends ? in_y.acceleration_at_end : ay + in_y.jerk * step;
    mixed.add(step, share * in_x.jerk + (1 - share) * in_y.jerk, share * ax + (1 - share) * ay);
    x_left = x_ends ? x.phases[++i].duration : x_left - step;
    y_left = y_ends ? y.phases[++k].duration : y_left - step;
  }
  return mixed;
}

// Both moves take the same time, but for its rounding, which may be long beside a ramp. Therefore the mixture is made
// from both ends towards the longest phases, wherever these overlap; the rounding falls between.
void append_mixture(double j, const AxisMove& rest, const StretchedMove& move, double duration,
                    AxisTrajectory& trajectory) noexcept {
  const double share = move.share;
  const JerkPhases x = phases_of(move.farthest, rest.af), y = phases_of(move.least, rest.af);
  const JerkPhases x_back = backwards(x, rest.a0), y_back = backwards(y, rest.a0);
  const std::size_t x_pivot = x.longest(), y_pivot = y.longest();
  JerkPhases front = mixture(x, x_pivot, y, y_pivot, share, rest.a0);
  JerkPhases back = mixture(x_back, x.count - 1 - x_pivot, y_back, y.count - 1 - y_pivot, share, rest.af);
  const double between = duration - front.duration() - back.duration();
  if (between < 0) {
    front = mixture(x, x.count, y, y.count, share, rest.a0);
    back = {};
  }
  for (std::size_t i = 0; i < front.count; ++i) {
    const JerkPhase& phase = front.phases[i];
    trajectory.add(phase.duration, phase.jerk * j, phase.acceleration_at_end * j);
  }
  const auto back_end = [&](std::size_t i) { return i > 0 ? back.phases[i - 1].acceleration_at_end : rest.af; };
  const double jerk = share * x.phases[x_pivot].jerk + (1 - share) * y.phases[y_pivot].jerk;
  trajectory.add(between, jerk * j, back_end(back.count) * j);
  for (std::size_t i = back.count; i-- > 0;) {
    trajectory.add(back.phases[i].duration, -back.phases[i].jerk * j, back_end(i) * j);
  }
}

bool rests(const MotionState& s) noexcept { return s.velocity == 0.0 && s.acceleration == 0.0; }

// From rest to rest time itself can run slower: the same path, every rate lower.
void slow_down_time(const AxisTask& task, double duration, AxisTrajectory& trajectory) noexcept {
  const AxisTrajectory fast = trajectory;
  trajectory.begin(task.start);
  if (fast.phase_count() == 0) trajectory.add(duration, 0.0, 0.0);
  const double k = duration / fast.duration(), jerk_share = 1 / (k * k * k);
  for (std::size_t i = 0; i < fast.phase_count(); ++i) {
    const double next = i + 1 < fast.phase_count() ? fast.phase(i + 1).start.acceleration : 0.0;
    trajectory.add(fast.phase(i).duration * k, fast.phase(i).jerk * jerk_share, next / (k * k));
  }
}

// What the interfaces differ in.
struct Interface {
  bool position;
  TrajectoryError (*check)(const AxisTask&) noexcept;
  AxisMove (*begin)(const AxisTask&, AxisTrajectory&) noexcept;
  ExtremalMove (*fastest)(const AxisMove&) noexcept;
  std::optional<StretchedMove> (*of_duration)(const AxisMove&, double) noexcept;
  double (*next_possible)(const AxisMove&, double) noexcept;

  [[nodiscard]] bool finish(const AxisTask& task, AxisTrajectory& trajectory) const noexcept {
    MotionState target = task.target;
    if (!position) target.position = trajectory.reached().position;
    return finish_at(target, trajectory);
  }
};

MotionPlan failure(TrajectoryError error, std::size_t axis) noexcept { return {error, axis, 0.0}; }

// The least time from `duration` on that every axis can take; infinite where rounding leaves none.
double common_duration(const Interface& way, std::span<const AxisTask> tasks,
                       std::span<const AxisTrajectory> trajectories, double duration) noexcept {
  constexpr int kMostSteps = 300;
  int steps = 0;
  AxisTrajectory brake;  // of the axis looked at
  for (bool changed = true; changed;) {
    changed = false;
    for (std::size_t i = 0; i < tasks.size(); ++i) {
      if (trajectories[i].duration() == duration) continue;  // its own least
      const AxisMove rest = way.begin(tasks[i], brake);
      if (brake.brake_duration() > 0) {  // the trajectory may have done without
        const double least = brake.duration() + way.fastest(rest).duration();
        changed = changed || least > duration;
        duration = std::max(duration, least);
      }
      // The next possible one may be missed by rounding: a little later, then.
      double more = 0.0;
      while (!way.of_duration(rest, duration - brake.duration())) {
        if (++steps > kMostSteps || !std::isfinite(duration)) return HUGE_VAL;
        const double next = brake.duration() + way.next_possible(rest, duration - brake.duration());
        more = std::max(2 * more, 4e-16 * duration);
        duration = next > duration ? next : duration + more;
        changed = true;
      }
    }
  }
  return duration;
}

MotionPlan plan_together(const Interface& way, std::span<const AxisTask> tasks, std::span<AxisTrajectory> trajectories,
                         Synchronization synchronization) noexcept {
  if (tasks.size() != trajectories.size()) return failure(TrajectoryError::sizes_differ, 0);
  MotionPlan plan;
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    const TrajectoryError error = way.check(tasks[i]);
    if (error != TrajectoryError::none) return failure(error, i);
    AxisMove rest = way.begin(tasks[i], trajectories[i]);
    ExtremalMove move;
    if (!(way.position && trajectories[i].brake_duration() > 0 &&
          begin_without_brake(tasks[i], trajectories[i], rest, move))) {
      move = way.fastest(rest);
    }
    append_move(tasks[i].limits.jerk, rest, move, trajectories[i]);
    if (!way.finish(tasks[i], trajectories[i])) return failure(TrajectoryError::out_of_range, i);
    plan.duration = std::max(plan.duration, trajectories[i].duration());
  }
  if (synchronization == Synchronization::none || tasks.size() < 2) return plan;
  plan.duration = common_duration(way, tasks, trajectories, plan.duration);
  if (!std::isfinite(plan.duration)) return failure(TrajectoryError::out_of_range, 0);
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    if (trajectories[i].duration() == plan.duration) continue;
    if (way.position && rests(tasks[i].start) && rests(tasks[i].target)) {
      slow_down_time(tasks[i], plan.duration, trajectories[i]);
      if (!way.finish(tasks[i], trajectories[i])) return failure(TrajectoryError::out_of_range, i);
      continue;
    }
    const AxisMove rest = way.begin(tasks[i], trajectories[i]);
    const double left = plan.duration - trajectories[i].duration();
    const auto move = way.of_duration(rest, left);
    if (!move) return failure(TrajectoryError::out_of_range, i);
    if (move->share == 1.0) {
      append_move(tasks[i].limits.jerk, rest, move->farthest, trajectories[i]);
    } else {
      append_mixture(tasks[i].limits.jerk, rest, *move, left, trajectories[i]);
    }
    if (!way.finish(tasks[i], trajectories[i])) return failure(TrajectoryError::out_of_range, i);
  }
  return plan;
}

}  // namespace

MotionPlan plan_positions(std::span<const AxisTask> tasks, std::span<AxisTrajectory> trajectories,
                          Synchronization synchronization) noexcept {
  constexpr Interface kPosition{true, check_task, begin_move, fastest_move, move_of_duration, next_possible_duration};
  return plan_together(kPosition, tasks, trajectories, synchronization);
}

MotionPlan plan_velocities(std::span<const AxisTask> tasks, std::span<AxisTrajectory> trajectories,
                           Synchronization synchronization) noexcept {
  constexpr Interface kVelocity{false,          check_change,       begin_change,
                                fastest_change, change_of_duration, next_possible_change};
  return plan_together(kVelocity, tasks, trajectories, synchronization);
}

}  // namespace stillcut
