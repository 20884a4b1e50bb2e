// The fastest move of one axis from any state (position, velocity, acceleration) to any other that keeps its limits on
// velocity, acceleration and jerk; up and down the limits may differ, but for the jerk. It may be planned again at any
// time in flight from the state then reached; position, velocity and acceleration do not jump.
//
// A start beyond the limits, or one that cannot help passing the velocity limit, is first brought back inside as fast
// as the jerk allows (the brake phases); from there the move is the fastest. How: docs/trajectories.md.
//
// Any consistent units. Pure functions of their arguments, noexcept, allocate nothing: fit for the real-time thread.
#pragma once

#include "rt/axis_trajectory.hpp"
#include "rt/extremal_moves.hpp"

namespace stillcut {

struct AxisTask {
  MotionState start, target;
  AxisLimits limits;
};

struct PositionPlan {
  TrajectoryError error = TrajectoryError::none;
  AxisTrajectory trajectory;  // to be used only without error
};

// The time-optimal move from `start` to `target`.
[[nodiscard]] PositionPlan plan_position(const MotionState& start, const MotionState& target,
                                         const AxisLimits& limits) noexcept;

// The same in steps, for several axes together. Whether the task can be done at all:
[[nodiscard]] TrajectoryError check_task(const AxisTask& task) noexcept;
// begins the trajectory with its brake phases and returns what is then left to do, divided by the jerk limit;
[[nodiscard]] AxisMove begin_move(const AxisTask& task, AxisTrajectory& trajectory) noexcept;
// where that had to brake: whether the move can be made without, as one in flight towards a target that it reaches just
// before its acceleration would take it beyond the velocity limit;
[[nodiscard]] bool begin_without_brake(const AxisTask& task, AxisTrajectory& trajectory, AxisMove& move,
                                       ExtremalMove& found) noexcept;
// appends an extremal move;
void append_move(double jerk, const AxisMove& rest, const ExtremalMove& move, AxisTrajectory& trajectory) noexcept;
// ends it at the target; false: the inputs are too far apart in scale.
[[nodiscard]] bool finish_at(const MotionState& target, AxisTrajectory& trajectory) noexcept;

// Steps of the velocity interface: the task's target position and limits of velocity do not count.
[[nodiscard]] TrajectoryError check_change(const AxisTask& task) noexcept;
[[nodiscard]] AxisMove begin_change(const AxisTask& task, AxisTrajectory& trajectory) noexcept;

}  // namespace stillcut
