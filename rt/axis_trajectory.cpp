#include "rt/axis_trajectory.hpp"

#include <algorithm>

namespace stillcut {
namespace {

MotionState moved(const MotionState& s, double jerk, double t) noexcept {
  return {s.position + t * (s.velocity + t * (s.acceleration / 2 + t * jerk / 6)),
          s.velocity + t * (s.acceleration + t * jerk / 2), s.acceleration + t * jerk};
}

}  // namespace

void AxisTrajectory::begin(const MotionState& start) noexcept {
  phases_[0] = {0.0, 0.0, start};
  count_ = 0;
  duration_ = brake_duration_ = 0.0;
  end_ = start;
}

void AxisTrajectory::add(double duration, double jerk, double acceleration_at_end) noexcept {
  if (!(duration > 0) || count_ == kMaxPhases) return;
  phases_[count_++] = {duration, jerk, end_};
  end_ = moved(end_, jerk, duration);
  end_.acceleration = acceleration_at_end;
  duration_ += duration;
}

MotionState AxisTrajectory::at(double t) const noexcept {
  if (!(t > 0)) return phases_[0].start;
  if (t >= duration_) return moved(end_, 0.0, t - duration_);
  for (std::size_t i = 0; i + 1 < count_; ++i) {
    if (t < phases_[i].duration) return moved(phases_[i].start, phases_[i].jerk, t);
    t -= phases_[i].duration;
  }
  // The last phase is reckoned back from the target, so that rounding fades as it is approached.
  const Phase& last = phases_[count_ - 1];
  return moved(end_, last.jerk, std::min(t - last.duration, 0.0));
}

}  // namespace stillcut
