// The fastest change of speed that respects a limit on acceleration and on jerk: how the spindle goes from the present
// speed to the corrected one without a jolt. One axis, velocity interface: from velocity v0 and acceleration a0 to vf
// and af. It may be planned again at any time in flight from the state it has then reached; velocity and
// acceleration do not jump.
//
// The jerk is always +jmax, 0 or -jmax (Pontryagin's principle for the double integrator with bounded second state): a
// ramp of the acceleration up to a peak, possibly a hold at the limit, a ramp to the target; mirrored when the speed
// must fall. A start beyond the acceleration limit is first brought back to it at full jerk (the brake phase).
//
// Any consistent units: acceleration per second, jerk per second squared. Pure functions of their arguments, noexcept,
// allocate nothing: fit for the real-time thread.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace stillcut {

struct MotionState {
  double position = 0.0;
  double velocity = 0.0;
  double acceleration = 0.0;
};

struct MotionLimits {
  double acceleration = 0.0;  // both signs, > 0
  double jerk = 0.0;          // both signs, > 0
};

enum class TrajectoryError : std::uint8_t {
  none,
  not_finite,                    // an input is NaN or infinite
  limit_not_positive,            // a limit is zero or negative
  target_beyond_limit,           // the target's acceleration is above the limit: it cannot be reached within it
  target_velocity_beyond_limit,  // the target's velocity is, or the one from which its acceleration must start
  sizes_differ,                  // not as many trajectories as tasks
  out_of_range                   // inputs so far apart in scale that the move cannot be expressed in doubles
};

// A short reason, for the user's line.
[[nodiscard]] const char* describe(TrajectoryError error) noexcept;

struct VelocityPlan;

// A planned move. A default-made one rests at zero.
class VelocityTrajectory {
 public:
  [[nodiscard]] double duration() const noexcept { return duration_; }                  // s
  [[nodiscard]] double brake_duration() const noexcept { return phases_[0].duration; }  // s, part of duration

  // The state t seconds after the start: the start before it; after the end, the target's acceleration goes on
  // (with none, the target velocity holds).
  [[nodiscard]] MotionState at(double t) const noexcept;

 private:
  friend VelocityPlan plan_velocity(const MotionState&, double, double, const MotionLimits&) noexcept;

  struct Phase {
    double duration = 0.0;
    double jerk = 0.0;
    MotionState start;
  };
  void set_phase(std::size_t index, double duration, double jerk, double acceleration_at_end) noexcept;

  std::array<Phase, 4> phases_{};  // brake, to the peak, hold, to the target
  double duration_ = 0.0;
  MotionState end_;
};

struct VelocityPlan {
  TrajectoryError error = TrajectoryError::none;
  VelocityTrajectory trajectory;  // to be used only without error
};

// The time-optimal move from `start` to the target velocity and acceleration.
[[nodiscard]] VelocityPlan plan_velocity(const MotionState& start, double target_velocity, double target_acceleration,
                                         const MotionLimits& limits) noexcept;

}  // namespace stillcut
