#include "rt/trajectory.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace stillcut {
namespace {

MotionState advance(const MotionState& s, double jerk, double t) noexcept {
  return {s.position + t * (s.velocity + t * (s.acceleration / 2 + t * jerk / 6)),
          s.velocity + t * (s.acceleration + t * jerk / 2), s.acceleration + t * jerk};
}

// What changing the acceleration from one value to another at full jerk adds to the velocity.
double velocity_of_ramp(double from, double to, double jerk) noexcept {
  return (from + to) / 2 * (std::abs(to - from) / jerk);
}

// A plain ramp between accelerations of one sign whose gap lies against them is followed by a long detour, however
// small the gap: the acceleration must pass through zero and return. A gap within rounding of the inputs is none;
// otherwise a move planned again on its last ramp would make that detour.
bool is_rounding_of_ramp(double gap, double v0, double vf, double a0, double af, double jerk) noexcept {
  if (a0 * af <= 0 || gap * a0 >= 0) return false;
  // A rounding of the acceleration moves the ramp in proportion to this.
  const double ramp_scale = a0 == af ? 0.0 : (a0 * a0 + af * af) / jerk;
  return std::abs(gap) <= 4 * std::numeric_limits<double>::epsilon() * (std::abs(v0) + std::abs(vf) + ramp_scale);
}

}  // namespace

const char* describe(TrajectoryError error) noexcept {
  switch (error) {
    case TrajectoryError::none:
      return "no error";
    case TrajectoryError::not_finite:
      return "an input is not a finite number";
    case TrajectoryError::limit_not_positive:
      return "the limits of acceleration and jerk must be above zero";
    case TrajectoryError::target_beyond_limit:
      return "the target acceleration is above the acceleration limit";
    case TrajectoryError::target_velocity_beyond_limit:
      return "the target velocity, or the one its acceleration starts from, is beyond the velocity limit";
    case TrajectoryError::sizes_differ:
      return "there are not as many trajectories as tasks";
    case TrajectoryError::out_of_range:
      return "the inputs are too far apart in scale";
  }
  return "unknown error";
}

void VelocityTrajectory::set_phase(std::size_t index, double duration, double jerk,
                                   double acceleration_at_end) noexcept {
  phases_[index] = {duration, jerk, end_};
  end_ = advance(end_, jerk, duration);
  end_.acceleration = acceleration_at_end;  // known without rounding: phases join exactly
  duration_ += duration;
}

MotionState VelocityTrajectory::at(double t) const noexcept {
  if (!(t > 0)) return phases_[0].start;
  if (t >= duration_) return advance(end_, 0.0, t - duration_);
  for (std::size_t i = 0; i < 3; ++i) {
    if (t < phases_[i].duration) return advance(phases_[i].start, phases_[i].jerk, t);
    t -= phases_[i].duration;
  }
  // The last ramp is reckoned back from the target, so that rounding fades as it is approached.
  return advance(end_, phases_[3].jerk, std::min(t - phases_[3].duration, 0.0));
}

VelocityPlan plan_velocity(const MotionState& start, double target_velocity, double target_acceleration,
                           const MotionLimits& limits) noexcept {
  VelocityPlan plan;
  const double inputs[] = {start.position,      start.velocity,      start.acceleration, target_velocity,
                           target_acceleration, limits.acceleration, limits.jerk};
  if (!std::all_of(std::begin(inputs), std::end(inputs), [](double x) { return std::isfinite(x); })) {
    plan.error = TrajectoryError::not_finite;
  } else if (limits.acceleration <= 0 || limits.jerk <= 0) {
    plan.error = TrajectoryError::limit_not_positive;
  } else if (std::abs(target_acceleration) > limits.acceleration) {
    plan.error = TrajectoryError::target_beyond_limit;
  }
  if (plan.error != TrajectoryError::none) return plan;

  VelocityTrajectory& move = plan.trajectory;
  move.end_ = start;
  const double j = limits.jerk;
  const double a0 = std::clamp(start.acceleration, -limits.acceleration, limits.acceleration);
  move.set_phase(0, std::abs(start.acceleration - a0) / j, std::copysign(j, -start.acceleration), a0);
  const double v0 = move.end_.velocity;

  // The plain ramp from a0 to the target acceleration leaves a gap in velocity. Its sign says to which side the
  // acceleration must bulge; mirrored by that sign, every bulge is upward.
  const double ramp = velocity_of_ramp(a0, target_acceleration, j);
  double gap = (target_velocity - v0) - ramp;
  if (is_rounding_of_ramp(gap, v0, target_velocity, a0, target_acceleration, j)) gap = 0;
  const double side = std::copysign(1.0, gap);
  gap = std::abs(gap);
  const double b0 = side * a0, bf = side * target_acceleration;
  const double high = std::max(b0, bf);

  // Two ramps between `high` and the peak add (peak^2 - high^2)/jmax, which fills the gap: peak^2 = jmax gap + high^2.
  // The difference peak - high is formed without cancellation where both are positive. With high < 0 the bulge first
  // takes back what it adds below zero; that is still the shortest way.
  const double peak = std::sqrt(j * gap + high * high);
  double rise = 0.0, hold = 0.0;  // from `high` to the peak; seconds at the limit
  if (gap > 0) {
    rise = high > 0 ? j * (gap / (peak + high)) : peak - high;
    if (high + rise > limits.acceleration) {
      rise = limits.acceleration - high;
      hold = std::max(0.0, (gap - rise * ((limits.acceleration + high) / j)) / limits.acceleration);
    }
  }
  const double top = hold > 0 ? limits.acceleration : std::min(high + rise, limits.acceleration);
  move.set_phase(1, (rise + (high - b0)) / j, side * j, side * top);
  move.set_phase(2, hold, 0.0, side * top);
  move.set_phase(3, (rise + (high - bf)) / j, -side * j, target_acceleration);
  move.end_.velocity = target_velocity;

  const double results[] = {move.duration_, move.end_.position, v0, gap, hold};
  if (!std::all_of(std::begin(results), std::end(results), [](double x) { return std::isfinite(x); })) {
    plan = {TrajectoryError::out_of_range, {}};
  }
  return plan;
}

}  // namespace stillcut
