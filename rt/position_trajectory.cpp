#include "rt/position_trajectory.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "rt/brake.hpp"
#include "rt/extremal_moves.hpp"

namespace stillcut {
namespace {

bool all_finite(const MotionState& s) noexcept {
  return std::isfinite(s.position) && std::isfinite(s.velocity) && std::isfinite(s.acceleration);
}

AxisMove scaled(const AxisTask& task) noexcept {
  const double per_jerk = 1 / task.limits.jerk;
  AxisMove move;
  move.v0 = task.start.velocity * per_jerk;
  move.a0 = task.start.acceleration * per_jerk;
  move.vf = task.target.velocity * per_jerk;
  move.af = task.target.acceleration * per_jerk;
  move.vmax = task.limits.velocity_max * per_jerk;
  move.vmin = task.limits.velocity_min * per_jerk;
  move.amax = task.limits.acceleration_max * per_jerk;
  move.amin = task.limits.acceleration_min * per_jerk;
  return move;
}

void set_distance(const AxisTask& task, double from, AxisMove& move) noexcept {
  const double to = task.target.position;
  move.distance = (to - from) / task.limits.jerk;
  move.distance_rounding =
      4 * std::numeric_limits<double>::epsilon() * (std::abs(to) + std::abs(from)) / task.limits.jerk;
}

}  // namespace

TrajectoryError check_change(const AxisTask& task) noexcept {
  const auto& [start, target, limits] = task;
  if (!all_finite(start) || !all_finite(target)) return TrajectoryError::not_finite;
  if (!std::isfinite(limits.acceleration_max) || !std::isfinite(limits.acceleration_min) ||
      !std::isfinite(limits.jerk)) {
    return TrajectoryError::not_finite;
  }
  if (!(limits.acceleration_max > 0 && limits.acceleration_min < 0 && limits.jerk > 0)) {
    return TrajectoryError::limit_not_positive;
  }
  if (target.acceleration > limits.acceleration_max || target.acceleration < limits.acceleration_min) {
    return TrajectoryError::target_beyond_limit;
  }
  return TrajectoryError::none;
}

TrajectoryError check_task(const AxisTask& task) noexcept {
  const auto& [start, target, limits] = task;
  if (!std::isfinite(limits.velocity_max) || !std::isfinite(limits.velocity_min)) return TrajectoryError::not_finite;
  if (const TrajectoryError error = check_change(task); error != TrajectoryError::none) return error;
  if (!(limits.velocity_max > 0 && limits.velocity_min < 0)) return TrajectoryError::limit_not_positive;
  // The speed just before the target, where the acceleration left zero, must be inside its limits too.
  const double ramp = target.acceleration * target.acceleration / (2 * limits.jerk);
  const double slack = 8 * std::numeric_limits<double>::epsilon() * (std::abs(target.velocity) + ramp);
  const double highest = target.velocity + (target.acceleration < 0 ? ramp : 0.0);
  const double lowest = target.velocity - (target.acceleration > 0 ? ramp : 0.0);
  if (highest - slack > limits.velocity_max || lowest + slack < limits.velocity_min) {
    return TrajectoryError::target_velocity_beyond_limit;
  }
  return TrajectoryError::none;
}

AxisMove begin_move(const AxisTask& task, AxisTrajectory& trajectory) noexcept {
  AxisMove move = scaled(task);
  trajectory.begin(task.start);
  if (const Brake brake = brake_of(move); brake.jerk != 0.0) {
    const double j = task.limits.jerk;
    move.a0 = brake.acceleration;
    trajectory.add(brake.ramp, brake.jerk * j, move.a0 * j);
    trajectory.add(brake.hold, 0.0, move.a0 * j);
    trajectory.end_brake();
    move.v0 = trajectory.reached().velocity / j;
  }
  set_distance(task, trajectory.reached().position, move);
  return move;
}

bool begin_without_brake(const AxisTask& task, AxisTrajectory& trajectory, AxisMove& move,
                         ExtremalMove& found) noexcept {
  const auto& [start, target, limits] = task;
  if (start.velocity > limits.velocity_max || start.velocity < limits.velocity_min) return false;
  if (!(start.acceleration * target.acceleration > 0)) return false;
  AxisMove unbraked = scaled(task);
  // An acceleration beyond its limit by rounding, as one reached in flight may be, is at it.
  const double a = std::clamp(unbraked.a0, unbraked.amin, unbraked.amax);
  if (std::abs(unbraked.a0 - a) > 8 * std::numeric_limits<double>::epsilon() * std::abs(a)) return false;
  unbraked.a0 = a;
  set_distance(task, start.position, unbraked);
  const auto extremal = fastest_move_of_one_sign(unbraked);
  if (!extremal) return false;
  move = unbraked;
  found = *extremal;
  trajectory.begin(start);
  return true;
}

AxisMove begin_change(const AxisTask& task, AxisTrajectory& trajectory) noexcept {
  AxisMove move = scaled(task);
  trajectory.begin(task.start);
  const double a = std::clamp(move.a0, move.amin, move.amax);
  if (a != move.a0) {
    const double j = task.limits.jerk;
    trajectory.add(std::abs(move.a0 - a), std::copysign(j, a - move.a0), a * j);
    trajectory.end_brake();
    move.a0 = a;
    move.v0 = trajectory.reached().velocity / j;
  }
  return move;
}

void append_move(double jerk, const AxisMove& rest, const ExtremalMove& move, AxisTrajectory& trajectory) noexcept {
  const double up = move.side * jerk, a_peak = move.peak * up, a_trough = move.trough * up;
  trajectory.add(move.rise, up, a_peak);
  trajectory.add(move.peak_hold, 0.0, a_peak);
  if (move.cruise > 0) {
    trajectory.add(move.peak, -up, 0.0);
    trajectory.add(move.cruise, 0.0, 0.0);
    trajectory.add(-move.trough, -up, a_trough);
  } else {
    trajectory.add(move.fall, -up, a_trough);
  }
  trajectory.add(move.trough_hold, 0.0, a_trough);
  trajectory.add(move.settle, up, rest.af * jerk);
}

bool finish_at(const MotionState& target, AxisTrajectory& trajectory) noexcept {
  const bool finite = std::isfinite(trajectory.duration()) && all_finite(trajectory.reached());
  trajectory.finish(target);
  return finite;
}

PositionPlan plan_position(const MotionState& start, const MotionState& target, const AxisLimits& limits) noexcept {
  const AxisTask task{start, target, limits};
  PositionPlan plan;
  plan.error = check_task(task);
  if (plan.error != TrajectoryError::none) return plan;
  AxisMove move = begin_move(task, plan.trajectory);
  ExtremalMove extremal;
  if (plan.trajectory.brake_duration() > 0 && begin_without_brake(task, plan.trajectory, move, extremal)) {
    append_move(limits.jerk, move, extremal, plan.trajectory);
  } else {
    append_move(limits.jerk, move, fastest_move(move), plan.trajectory);
  }
  if (!finish_at(target, plan.trajectory)) plan = {TrajectoryError::out_of_range, {}};
  return plan;
}

}  // namespace stillcut
