#include "rt/cut_setting.hpp"

#include <algorithm>

#include "rt/position_trajectory.hpp"

namespace stillcut {
namespace {

constexpr double kRampUp_s = 0.1;  // in which feed and direction reach their largest rate

}  // namespace

void SettingMotion::begin(const CutSetting& start) noexcept {
  target_ = start;
  started_ = longest_ = 0.0;
  speed_ = plan_velocity({0.0, start.speed, 0.0}, start.speed, 0.0, {1.0, 1.0}).trajectory;
  feed_ = plan_velocity({0.0, start.feed_factor, 0.0}, start.feed_factor, 0.0, {1.0, 1.0}).trajectory;
  direction_.begin({start.feed_direction, 0.0, 0.0});
  direction_.finish({start.feed_direction, 0.0, 0.0});
}

bool SettingMotion::move_to(const CutSetting& target, double t, const CompensationLimits& limits,
                            double pace) noexcept {
  const double in = t - started_;
  // What is under way is slowed as hard as the limits allow: gently it would run past where it was going, which may be
  // the end of the spindle's range or of the path's freedom.
  const double slowing = in < longest_ ? 1.0 : pace;
  const SpindleLimits& spindle = limits.spindle;
  const VelocityPlan speed =
      plan_velocity(speed_.at(in), target.speed, 0.0, {pace * spindle.acceleration, slowing * spindle.jerk});
  const double feed_rate = limits.feed_override_rate;
  const VelocityPlan feed =
      plan_velocity(feed_.at(in), target.feed_factor, 0.0, {pace * feed_rate, slowing * feed_rate / kRampUp_s});
  const double turn_acceleration = slowing * limits.turn_rate / kRampUp_s;
  const PositionPlan direction =
      plan_position(direction_.at(in), {target.feed_direction, 0.0, 0.0},
                    symmetric_limits(pace * limits.turn_rate, turn_acceleration, turn_acceleration / kRampUp_s));
  if (speed.error != TrajectoryError::none || feed.error != TrajectoryError::none ||
      direction.error != TrajectoryError::none)
    return false;
  target_ = target;
  speed_ = speed.trajectory;
  feed_ = feed.trajectory;
  direction_ = direction.trajectory;
  started_ = t;
  longest_ = std::max({speed_.duration(), feed_.duration(), direction_.duration()});
  return true;
}

MovingSetting SettingMotion::at(double t) const noexcept {
  const double in = t - started_;
  const bool moving = in < longest_;
  const bool at_mean = in >= speed_.duration();
  return {{speed_.at(in).velocity, at_mean ? target_.variation_ratio : 0.0, at_mean ? target_.variation_hz : 0.0,
           feed_.at(in).velocity, direction_.at(in).position},
          moving};
}

}  // namespace stillcut
