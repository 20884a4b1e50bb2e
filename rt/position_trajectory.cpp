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

}  // namespace

TrajectoryError check_task(const AxisTask& task) noexcept {
  const auto& [start, target, limits] = task;
  if (!all_finite(start) || !all_finite(target)) return TrajectoryError::not_finite;
  for (double x : {limits.velocity_max, limits.velocity_min, limits.acceleration_max, limits.acceleration_min}) {
    if (!std::isfinite(x)) return TrajectoryError::not_finite;
  }
  if (!std::isfinite(limits.jerk)) return TrajectoryError::not_finite;
  if (!(limits.velocity_max > 0 && limits.velocity_min < 0 && limits.acceleration_max > 0 &&
        limits.acceleration_min < 0 && limits.jerk > 0)) {
    return TrajectoryError::limit_not_positive;
  }
  if (target.acceleration > limits.acceleration_max || target.acceleration < limits.acceleration_min) {
    return TrajectoryError::target_beyond_limit;
  }
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
  const auto& [start, target, limits] = task;
  const double j = limits.jerk, per_jerk = 1 / j;
  AxisMove move;
  move.v0 = start.velocity * per_jerk;
  move.a0 = start.acceleration * per_jerk;
  move.vf = target.velocity * per_jerk;
  move.af = target.acceleration * per_jerk;
  move.vmax = limits.velocity_max * per_jerk;
  move.vmin = limits.velocity_min * per_jerk;
  move.amax = limits.acceleration_max * per_jerk;
  move.amin = limits.acceleration_min * per_jerk;

  trajectory.begin(start);
  const Brake brake = brake_of(move);
  if (brake.jerk != 0.0) {
    move.a0 = std::clamp(move.a0 + brake.jerk * brake.ramp, move.amin, move.amax);
    trajectory.add(brake.ramp, brake.jerk * j, move.a0 * j);
    trajectory.add(brake.hold, 0.0, move.a0 * j);
    trajectory.end_brake();
    move.v0 = trajectory.reached().velocity * per_jerk;
  }
  const double from = trajectory.reached().position;
  move.distance = (target.position - from) * per_jerk;
  move.distance_rounding =
      2 * std::numeric_limits<double>::epsilon() * (std::abs(target.position) + std::abs(from)) * per_jerk;
  return move;
}

bool append_move(const AxisTask& task, const AxisMove& rest, const ExtremalMove& move,
                 AxisTrajectory& trajectory) noexcept {
  const double up = move.side * task.limits.jerk, a_peak = move.peak * up, a_trough = move.trough * up;
  trajectory.add(move.peak - move.side * rest.a0, up, a_peak);
  trajectory.add(move.peak_hold, 0.0, a_peak);
  if (move.cruise > 0) {
    trajectory.add(move.peak, -up, 0.0);
    trajectory.add(move.cruise, 0.0, 0.0);
    trajectory.add(-move.trough, -up, a_trough);
  } else {
    trajectory.add(move.peak - move.trough, -up, a_trough);
  }
  trajectory.add(move.trough_hold, 0.0, a_trough);
  trajectory.add(move.side * rest.af - move.trough, up, task.target.acceleration);
  return finish_at_target(task, trajectory);
}

bool finish_at_target(const AxisTask& task, AxisTrajectory& trajectory) noexcept {
  const bool finite = std::isfinite(trajectory.duration()) && all_finite(trajectory.reached());
  trajectory.finish(task.target);
  return finite;
}

PositionPlan plan_position(const MotionState& start, const MotionState& target, const AxisLimits& limits) noexcept {
  const AxisTask task{start, target, limits};
  PositionPlan plan;
  plan.error = check_task(task);
  if (plan.error != TrajectoryError::none) return plan;
  const AxisMove move = begin_move(task, plan.trajectory);
  if (!append_move(task, move, fastest_move(move), plan.trajectory)) plan = {TrajectoryError::out_of_range, {}};
  return plan;
}

}  // namespace stillcut
