#include "rt/position_trajectory.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "rt/brake.hpp"
#include "rt/extremal_moves.hpp"

namespace stillcut {
namespace {

constexpr double kUnitRoundoff = std::numeric_limits<double>::epsilon();

MotionState moved(const MotionState& s, double jerk, double t) noexcept {
  return {s.position + t * (s.velocity + t * (s.acceleration / 2 + t * jerk / 6)),
          s.velocity + t * (s.acceleration + t * jerk / 2), s.acceleration + t * jerk};
}

bool all_finite(const MotionState& s) noexcept {
  return std::isfinite(s.position) && std::isfinite(s.velocity) && std::isfinite(s.acceleration);
}

TrajectoryError check(const MotionState& start, const MotionState& target, const AxisLimits& limits) noexcept {
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
  const double slack = 8 * kUnitRoundoff * (std::abs(target.velocity) + ramp);
  const double highest = target.velocity + (target.acceleration < 0 ? ramp : 0.0);
  const double lowest = target.velocity - (target.acceleration > 0 ? ramp : 0.0);
  if (highest - slack > limits.velocity_max || lowest + slack < limits.velocity_min) {
    return TrajectoryError::target_velocity_beyond_limit;
  }
  return TrajectoryError::none;
}

}  // namespace

// Fills a trajectory phase by phase.
class TrajectoryBuilder {
 public:
  TrajectoryBuilder(PositionTrajectory& trajectory, const MotionState& start) noexcept : t_{trajectory} {
    t_.phases_[0].start = start;
    t_.end_ = start;
  }
  // Nothing is added for a phase without duration.
  void add(double duration, double jerk, double acceleration_at_end) noexcept {
    if (!(duration > 0)) return;
    t_.phases_[t_.count_++] = {duration, jerk, t_.end_};
    t_.end_ = moved(t_.end_, jerk, duration);
    t_.end_.acceleration = acceleration_at_end;  // known without rounding: phases join exactly
    t_.duration_ += duration;
  }
  void end_brake() noexcept { t_.brake_duration_ = t_.duration_; }
  [[nodiscard]] const MotionState& state() const noexcept { return t_.end_; }
  void finish(const MotionState& target) noexcept { t_.end_ = target; }

 private:
  PositionTrajectory& t_;
};

MotionState PositionTrajectory::at(double t) const noexcept {
  if (!(t > 0)) return phases_[0].start;
  if (t >= duration_) return moved(end_, 0.0, t - duration_);
  for (std::size_t i = 0; i + 1 < count_; ++i) {
    if (t < phases_[i].duration) return moved(phases_[i].start, phases_[i].jerk, t);
    t -= phases_[i].duration;
  }
  if (count_ == 0) return end_;
  // The last ramp is reckoned back from the target, so that rounding fades as it is approached.
  const Phase& last = phases_[count_ - 1];
  return moved(end_, last.jerk, std::min(t - last.duration, 0.0));
}

PositionPlan plan_position(const MotionState& start, const MotionState& target, const AxisLimits& limits) noexcept {
  PositionPlan plan;
  plan.error = check(start, target, limits);
  if (plan.error != TrajectoryError::none) return plan;

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

  TrajectoryBuilder builder{plan.trajectory, start};
  const Brake brake = brake_of(move);
  if (brake.jerk != 0.0) {
    const double a = std::clamp(move.a0 + brake.jerk * brake.ramp, move.amin, move.amax);
    builder.add(brake.ramp, brake.jerk * j, a * j);
    builder.add(brake.hold, 0.0, a * j);
    builder.end_brake();
    move.v0 = builder.state().velocity * per_jerk;
    move.a0 = a;
  }
  move.distance = (target.position - builder.state().position) * per_jerk;
  move.distance_rounding =
      2 * kUnitRoundoff * (std::abs(target.position) + std::abs(builder.state().position)) * per_jerk;

  const ExtremalMove best = fastest_move(move);
  const double up = best.side * j, a_peak = best.peak * up, a_trough = best.trough * up;
  builder.add(best.peak - best.side * move.a0, up, a_peak);
  builder.add(best.peak_hold, 0.0, a_peak);
  if (best.cruise > 0) {
    builder.add(best.peak, -up, 0.0);
    builder.add(best.cruise, 0.0, 0.0);
    builder.add(-best.trough, -up, a_trough);
  } else {
    builder.add(best.peak - best.trough, -up, a_trough);
  }
  builder.add(best.trough_hold, 0.0, a_trough);
  builder.add(best.side * move.af - best.trough, up, target.acceleration);
  const MotionState reached = builder.state();
  builder.finish(target);
  if (!std::isfinite(plan.trajectory.duration()) || !all_finite(reached)) plan = {TrajectoryError::out_of_range, {}};
  return plan;
}

}  // namespace stillcut
