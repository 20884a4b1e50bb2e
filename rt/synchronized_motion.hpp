// Several axes that move together. With time synchronization all arrive at once, in the least time in which every one
// of them can: an axis that would be earlier is stretched to exactly that time.
//
// The velocity interface goes to given velocities and accelerations, wherever the positions then are.
//
// Any consistent units. Noexcept, allocates nothing; results go to the caller's storage. For the real-time thread.
#pragma once

#include <cstddef>
#include <span>

#include "rt/position_trajectory.hpp"

namespace stillcut {

enum class Synchronization { none, time };

struct MotionPlan {
  TrajectoryError error = TrajectoryError::none;
  std::size_t axis = 0;   // the one with the error
  double duration = 0.0;  // s, of the longest
};

// One trajectory a task; as many of both, else TrajectoryError::sizes_differ. Usable only without error.
[[nodiscard]] MotionPlan plan_positions(std::span<const AxisTask> tasks, std::span<AxisTrajectory> trajectories,
                                        Synchronization synchronization) noexcept;

// Of the tasks' targets only velocity and acceleration count, and of their limits acceleration and jerk.
[[nodiscard]] MotionPlan plan_velocities(std::span<const AxisTask> tasks, std::span<AxisTrajectory> trajectories,
                                         Synchronization synchronization) noexcept;

}  // namespace stillcut
