// The fastest move of one axis from any state (position, velocity, acceleration) to any other that keeps its limits on
// velocity, acceleration and jerk, each with a limit of its own up and down (jerk excepted). It may be planned again at
// any time in flight from the state then reached; position, velocity and acceleration do not jump.
//
// A start beyond the limits, or one that cannot help passing the velocity limit, is first brought back inside as fast
// as the jerk allows (the brake phases); from there the move is the fastest. How: docs/trajectories.md.
//
// Any consistent units: velocity per second, acceleration per second squared, jerk per second cubed. Pure functions of
// their arguments, noexcept, allocate nothing: fit for the real-time thread.
#pragma once

#include <array>
#include <cstddef>

#include "rt/trajectory.hpp"

namespace stillcut {

struct AxisLimits {
  double velocity_max = 0.0, velocity_min = 0.0;          // min < 0 < max
  double acceleration_max = 0.0, acceleration_min = 0.0;  // min < 0 < max
  double jerk = 0.0;                                      // both signs, > 0
};

[[nodiscard]] constexpr AxisLimits symmetric_limits(double velocity, double acceleration, double jerk) noexcept {
  return {velocity, -velocity, acceleration, -acceleration, jerk};
}

// A planned move: phases of constant jerk. A default-made one rests at zero.
class PositionTrajectory {
 public:
  static constexpr std::size_t kMaxPhases = 9;

  [[nodiscard]] double duration() const noexcept { return duration_; }              // s
  [[nodiscard]] double brake_duration() const noexcept { return brake_duration_; }  // s, part of duration

  // The state t seconds after the start: the start before it; after the end, the target's acceleration goes on.
  [[nodiscard]] MotionState at(double t) const noexcept;

 private:
  friend class TrajectoryBuilder;

  struct Phase {
    double duration = 0.0;
    double jerk = 0.0;
    MotionState start;
  };
  std::array<Phase, kMaxPhases> phases_{};
  std::size_t count_ = 0;
  double duration_ = 0.0, brake_duration_ = 0.0;
  MotionState end_;
};

struct PositionPlan {
  TrajectoryError error = TrajectoryError::none;
  PositionTrajectory trajectory;  // to be used only without error
};

// The time-optimal move from `start` to `target`.
[[nodiscard]] PositionPlan plan_position(const MotionState& start, const MotionState& target,
                                         const AxisLimits& limits) noexcept;

}  // namespace stillcut
