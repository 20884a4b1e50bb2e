// A planned move of one axis as phases of constant jerk, evaluated at any time; the limits it keeps.
//
// Any consistent units: velocity per second, acceleration per second squared, jerk per second cubed. Noexcept, allocate
// nothing: fit for the real-time thread.
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

// A default-made one rests at zero.
class AxisTrajectory {
 public:
  // Two of the brake; a move stretched to a given duration mixes two of seven phases each.
  static constexpr std::size_t kMaxPhases = 16;

  struct Phase {
    double duration = 0.0;  // s
    double jerk = 0.0;
    MotionState start;
  };

  [[nodiscard]] double duration() const noexcept { return duration_; }              // s
  [[nodiscard]] double brake_duration() const noexcept { return brake_duration_; }  // s, part of duration
  [[nodiscard]] std::size_t phase_count() const noexcept { return count_; }
  [[nodiscard]] const Phase& phase(std::size_t i) const noexcept { return phases_[i]; }

  // The state t seconds after the start: the start before it; after the end, the target's acceleration goes on.
  [[nodiscard]] MotionState at(double t) const noexcept;

  // Planning, phase by phase: begin, add, finish.
  void begin(const MotionState& start) noexcept;
  // Appends a phase; one without duration is left out. The acceleration at its end is known to the caller without
  // rounding, so that phases join exactly.
  void add(double duration, double jerk, double acceleration_at_end) noexcept;
  void end_brake() noexcept { brake_duration_ = duration_; }
  [[nodiscard]] const MotionState& reached() const noexcept { return end_; }
  // What is left to the target is rounding.
  void finish(const MotionState& target) noexcept { end_ = target; }

 private:
  std::array<Phase, kMaxPhases> phases_{};
  std::size_t count_ = 0;
  double duration_ = 0.0, brake_duration_ = 0.0;
  MotionState end_;
};

}  // namespace stillcut
