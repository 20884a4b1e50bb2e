// Random tasks for one axis and what a valid answer must fulfil, for the tests of trajectories.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <sstream>
#include <string>

#include "rt/position_trajectory.hpp"

namespace stillcut {

inline std::string text(const AxisTask& task) {
  std::ostringstream out;
  out.precision(17);
  const auto state = [&](const MotionState& s) {
    out << "{" << s.position << ", " << s.velocity << ", " << s.acceleration << "}";
  };
  state(task.start);
  out << " -> ";
  state(task.target);
  const AxisLimits& l = task.limits;
  out << " v " << l.velocity_min << ".." << l.velocity_max << " a " << l.acceleration_min << ".." << l.acceleration_max
      << " j " << l.jerk;
  return out.str();
}

// Limits at scales of their own, up to 1e-6 to 1e6; states inside them, often on them, at rest or equal; distances from
// none to far beyond what the limits make short.
class MotionCases {
 public:
  explicit MotionCases(std::uint64_t seed) : random_{seed} {}

  AxisTask next() {
    for (;;) {
      const AxisTask task = draw();
      if (check_task(task) == TrajectoryError::none) return task;
    }
  }
  // The start somewhere beyond the limits.
  AxisTask beyond() {
    AxisTask task = next();
    const AxisLimits& l = task.limits;
    task.start.velocity = l.velocity_max * signed_unit() * scale(1.0);
    task.start.acceleration = l.acceleration_max * signed_unit() * scale(1.0);
    return task;
  }

  double unit() { return std::uniform_real_distribution<double>{0.0, 1.0}(random_); }
  double signed_unit() { return 2.0 * unit() - 1.0; }
  double scale(double decades) { return std::pow(10.0, decades * signed_unit()); }
  bool one_in(unsigned n) { return random_() % n == 0; }

 private:
  AxisTask draw() {
    constexpr double kDecades[] = {6.0, 4.0, 2.0, 0.3};
    const double decades = kDecades[random_() % 4];
    AxisTask task;
    task.limits = symmetric_limits(scale(decades), scale(decades), scale(decades));
    AxisLimits& l = task.limits;
    if (one_in(3)) {
      l.velocity_min *= scale(1.0);
      l.acceleration_min *= scale(1.0);
    }
    task.start = state(l, 1.0);
    task.target = state(l, -1.0);
    if (one_in(10)) task.target.velocity = task.start.velocity;
    if (one_in(10)) task.target.acceleration = task.start.acceleration;
    const double v = l.velocity_max, a = l.acceleration_max, j = l.jerk;
    const double time = std::max({v / a, a / j, std::sqrt(v / j)});
    const double distances[] = {0.0,
                                signed_unit() * v * time,
                                signed_unit() * scale(6.0),
                                signed_unit() * v * time * scale(3.0),
                                signed_unit() * v * v / a,
                                signed_unit() * std::pow(task.start.acceleration, 3) / j / j,
                                (task.start.velocity + task.target.velocity) / 2 * unit() * time};
    const double distance = distances[random_() % std::size(distances)];
    task.start.position = one_in(2) ? 0.0 : signed_unit() * std::abs(distance);
    task.target.position = task.start.position + distance;
    return task;
  }

  // `side` 1: the acceleration can be taken back inside the limits; -1: it can have been built up inside them.
  MotionState state(const AxisLimits& l, double side) {
    MotionState s;
    const double reach = one_in(2) ? l.acceleration_max : std::sqrt(2 * l.jerk * l.velocity_max);
    s.acceleration = std::clamp(signed_unit() * reach, l.acceleration_min, l.acceleration_max);
    if (one_in(4)) s.acceleration = 0.0;
    if (one_in(8)) s.acceleration = one_in(2) ? l.acceleration_max : l.acceleration_min;
    const double ramp = s.acceleration * s.acceleration / (2 * l.jerk);
    double high = l.velocity_max, low = l.velocity_min;
    (s.acceleration * side > 0 ? high : low) -= s.acceleration * side > 0 ? ramp : -ramp;
    if (high < low) return {0.0, unit() * l.velocity_max, 0.0};
    s.velocity = low + (high - low) * unit();
    if (one_in(8)) s.velocity = high;
    if (one_in(8)) s.velocity = low;
    if (one_in(8) && low < 0 && high > 0) s.velocity = 0.0;
    return s;
  }

  std::mt19937_64 random_;
};

// The largest speed, acceleration and distance in this move, for tolerances.
inline MotionState largest_of(const AxisTask& task, const AxisTrajectory& move) {
  MotionState s = task.target;
  const auto widen = [&](const MotionState& x) {
    s.position = std::max(std::abs(s.position), std::abs(x.position));
    s.velocity = std::max(std::abs(s.velocity), std::abs(x.velocity));
    s.acceleration = std::max(std::abs(s.acceleration), std::abs(x.acceleration));
  };
  widen(task.start);
  for (std::size_t i = 0; i < move.phase_count(); ++i) widen(move.phase(i).start);
  s.position += s.velocity * move.duration();
  return s;
}

// What is wrong with a trajectory: nothing, if empty. It is integrated phase by phase, independently of its own
// evaluation, and looked at in every phase where an extreme of velocity can lie. Once inside its limits it stays there;
// the jerk's limit holds always, the acceleration's from the end of the brake on.
// A stretched move is a mixture of the farthest and the least far: rounding is relative to what these reach.
enum class Stretched { no, yes };
inline std::string fault_of(const AxisTask& task, const AxisTrajectory& move, Stretched stretched = Stretched::no) {
  const AxisLimits& l = task.limits;
  MotionState scale = largest_of(task, move);
  if (stretched == Stretched::yes) {
    const double t = move.duration();
    scale.acceleration += std::min(std::max(l.acceleration_max, -l.acceleration_min), l.jerk * t);
    scale.velocity += std::min(std::max(l.velocity_max, -l.velocity_min), scale.acceleration * t);
    scale.position += scale.velocity * t;
  }
  constexpr double kRounding = 1e-11;
  // A time is rounded to some 1e-16 of the duration, in which the state moves on.
  const double tick = 4e-15 * move.duration();
  const double a_slack = kRounding * scale.acceleration + l.jerk * tick;
  const double v_slack = kRounding * scale.velocity + scale.acceleration * tick;
  // An instant without acceleration, up to a/j away, is what the plan reckons from; and where a distance differs from
  // that of the fastest change of velocity by what rounding of the velocities explains, up to 1e-10, it counts as
  // equal.
  const double p_slack = kRounding * scale.position +
                         scale.velocity * (tick + 3e-10 * move.duration() + 1e-14 * scale.acceleration / l.jerk);
  MotionState s = task.start;
  double time = 0.0;
  bool returned = move.brake_duration() == 0.0;  // inside the limits, where every state is from then on
  const auto beyond = [](double x, double low, double high, double slack) {
    return x > high + slack || x < low - slack;
  };
  const auto outside = [&](const MotionState& x) {
    return beyond(x.velocity, l.velocity_min, l.velocity_max, v_slack) ||
           beyond(x.acceleration, l.acceleration_min, l.acceleration_max, a_slack);
  };
  const auto differs = [&](const MotionState& x, const MotionState& y) {
    return !(std::abs(x.position - y.position) <= p_slack && std::abs(x.velocity - y.velocity) <= v_slack &&
             std::abs(x.acceleration - y.acceleration) <= a_slack);
  };
  const auto after = [](const MotionState& x, double jerk, double t) {
    return MotionState{x.position + x.velocity * t + x.acceleration * t * t / 2 + jerk * t * t * t / 6,
                       x.velocity + x.acceleration * t + jerk * t * t / 2, x.acceleration + jerk * t};
  };
  for (std::size_t i = 0; i < move.phase_count(); ++i) {
    const auto& phase = move.phase(i);
    if (!(phase.duration >= 0) || !std::isfinite(phase.duration))
      return "a duration is " + std::to_string(phase.duration);
    if (std::abs(phase.jerk) > l.jerk * (1 + 1e-12)) return "the jerk is above its limit";
    if (differs(s, phase.start)) return "phase " + std::to_string(i) + " does not begin where the last one ended";
    s.acceleration = phase.start.acceleration;  // its last bit, held for long, moves the velocity
    const double turn = phase.jerk != 0 ? -s.acceleration / phase.jerk : -1.0;
    if (returned && turn > 0 && turn < phase.duration && outside(after(s, phase.jerk, turn))) {
      return "beyond a limit within phase " + std::to_string(i);
    }
    for (double share : {0.25, 0.5, 0.75}) {
      const double t = share * phase.duration;
      if (differs(after(s, phase.jerk, t), move.at(time + t))) return "the state is not the integral of the jerk";
    }
    s = after(s, phase.jerk, phase.duration);
    time += phase.duration;
    if (returned && outside(s)) return "beyond a limit after phase " + std::to_string(i);
    returned = returned || !outside(s);
    if (!returned && time > move.brake_duration() + tick &&
        beyond(s.acceleration, l.acceleration_min, l.acceleration_max, a_slack)) {
      return "the brake leaves the acceleration beyond its limit";
    }
  }
  if (!returned) return "never inside the limits";
  if (std::abs(time - move.duration()) > tick * 4) return "the phases do not add up to the duration";
  if (differs(s, task.target)) return "the target is missed";
  return {};
}

// Backwards in time.
inline AxisTask reversed(const AxisTask& task) {
  AxisTask r = task;
  r.start = {task.target.position, -task.target.velocity, task.target.acceleration};
  r.target = {task.start.position, -task.start.velocity, task.start.acceleration};
  r.limits.velocity_max = -task.limits.velocity_min;
  r.limits.velocity_min = -task.limits.velocity_max;
  return r;
}

}  // namespace stillcut
