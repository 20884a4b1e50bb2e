// What a correction sets, all of it at once, and how it moves from one setting to the next: spindle speed and feed on
// velocity-interface trajectories, the feed direction on a position trajectory, so that nothing jumps.
#pragma once

#include "rt/axis_trajectory.hpp"
#include "rt/compensation_limits.hpp"
#include "rt/signals.hpp"
#include "rt/trajectory.hpp"

namespace stillcut {

struct CutSetting {
  double speed = 0.0;            // of the spindle, rad/s; the mean where it varies
  double variation_ratio = 0.0;  // amplitude over mean; 0: constant
  double variation_hz = 0.0;
  double feed_factor = 1.0;     // over the feed that keeps the programmed feed per tooth; 0: stop
  double feed_direction = 0.0;  // rad
};

struct MovingSetting {
  CutSetting now;
  bool moving = false;
};

class SettingMotion {
 public:
  // From rest at `start`.
  void begin(const CutSetting& start) noexcept;
  // On to `target` from where it stands at time `t` (s since begin, never going back). `pace` scales the limits of
  // rate, acceleration and jerk: 1 backs off as fast as they allow, less returns gently, once what is under way has
  // been slowed. False: there is no such move, and the old one goes on.
  bool move_to(const CutSetting& target, double t, const CompensationLimits& limits, double pace) noexcept;

  // The variation sets in when its mean is reached.
  [[nodiscard]] MovingSetting at(double t) const noexcept;
  [[nodiscard]] const CutSetting& target() const noexcept { return target_; }
  [[nodiscard]] double arrives_at() const noexcept { return started_ + longest_; }  // s since begin

 private:
  CutSetting target_;
  VelocityTrajectory speed_, feed_;
  AxisTrajectory direction_;
  double started_ = 0.0, longest_ = 0.0;
};

}  // namespace stillcut
