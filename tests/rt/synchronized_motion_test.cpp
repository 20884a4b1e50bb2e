#include "rt/synchronized_motion.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "rt/stretched_move.hpp"
#include "tests/rt/motion_cases.hpp"

namespace stillcut {
namespace {

// Axes of like scales, so that durations are comparable.
std::vector<AxisTask> random_axes(MotionCases& cases, std::size_t count, double decades) {
  std::vector<AxisTask> tasks;
  while (tasks.size() < count) {
    const AxisTask task = cases.next();
    const AxisLimits& l = task.limits;
    const auto like_one = [&](double x) { return std::abs(std::log10(x)) < decades; };
    if (like_one(l.velocity_max) && like_one(l.acceleration_max) && like_one(l.jerk)) tasks.push_back(task);
  }
  return tasks;
}

// The velocity interface leaves the position free and keeps no limit of velocity.
std::string fault_of_change(AxisTask task, const AxisTrajectory& move) {
  task.target.position = move.at(move.duration()).position;
  double fastest = std::max(std::abs(task.start.velocity), std::abs(task.target.velocity));
  for (std::size_t i = 0; i < move.phase_count(); ++i) {
    fastest = std::max(fastest, std::abs(move.phase(i).start.velocity) +
                                    std::abs(move.phase(i).start.acceleration) * move.phase(i).duration);
  }
  task.limits.velocity_max = 2 * fastest + 1;
  task.limits.velocity_min = -task.limits.velocity_max;
  return fault_of(task, move, Stretched::yes);
}

TEST(SynchronizedMotion, ArrivesAtOnceAndKeepsEveryLimit) {
  MotionCases cases{21};
  int waited = 0;
  for (int i = 0; i < 10'000; ++i) {
    const std::size_t axes = 2 + static_cast<std::size_t>(cases.unit() * 6);
    std::vector<AxisTask> tasks = random_axes(cases, axes, i % 2 == 0 ? 1.0 : 6.0);
    if (i % 10 == 0) tasks[0] = cases.beyond();
    std::vector<AxisTrajectory> moves(axes);
    const MotionPlan alone = plan_positions(tasks, moves, Synchronization::none);
    ASSERT_EQ(alone.error, TrajectoryError::none);
    double longest = 0.0;
    for (const AxisTrajectory& move : moves) longest = std::max(longest, move.duration());
    ASSERT_EQ(alone.duration, longest);
    const MotionPlan together = plan_positions(tasks, moves, Synchronization::time);
    ASSERT_EQ(together.error, TrajectoryError::none) << text(tasks[together.axis]);
    ASSERT_GE(together.duration, longest);
    waited += together.duration > longest * (1 + 1e-9) ? 1 : 0;
    for (std::size_t k = 0; k < axes; ++k) {
      ASSERT_NEAR(moves[k].duration(), together.duration, 1e-12 * together.duration) << text(tasks[k]);
      ASSERT_EQ(fault_of(tasks[k], moves[k], Stretched::yes), "") << text(tasks[k]) << " in " << together.duration;
    }
  }
  EXPECT_GT(waited, 50) << "some axis cannot take the time of the slowest: seldom, but that must be met";
}

// Any move made at random, in the time it took, is among the possible ones.
TEST(StretchedMove, ExistsForEveryDurationThatAMoveFoundAtRandomTakes) {
  MotionCases cases{22};
  int compared = 0;
  while (compared < 30'000) {
    AxisTask task = cases.next();
    task.start.position = 0.0;
    const AxisLimits& l = task.limits;
    const double scale = std::min({l.acceleration_max / l.jerk, std::sqrt(l.velocity_max / l.jerk)}) * cases.scale(1.0);
    AxisTrajectory made;
    made.begin(task.start);
    for (int i = 0; i < 6; ++i) {
      const double t = scale * cases.unit(), jerk = l.jerk * cases.signed_unit();
      made.add(t, jerk, made.reached().acceleration + jerk * t);
    }
    task.target = made.reached();
    if (check_task(task) != TrajectoryError::none || !fault_of(task, made).empty()) continue;
    if (largest_of(task, made).acceleration * made.duration() < 1e-6 * std::abs(task.start.velocity)) continue;
    AxisTrajectory brake;
    const AxisMove rest = begin_move(task, brake);
    if (brake.duration() > 0) continue;
    ASSERT_TRUE(move_of_duration(rest, made.duration()).has_value()) << text(task) << " in " << made.duration();
    ++compared;
  }
}

// Between an impossible duration and the next possible one, every other is impossible too.
TEST(StretchedMove, NextPossibleDurationIsTheNext) {
  MotionCases cases{23};
  int gaps = 0;
  for (int i = 0; i < 100'000; ++i) {
    const AxisTask task = random_axes(cases, 1, 1.0).front();
    AxisTrajectory brake;
    const AxisMove rest = begin_move(task, brake);
    if (brake.duration() > 0) continue;
    const double least = fastest_move(rest).duration();
    ASSERT_TRUE(move_of_duration(rest, least * (1 + 1e-9)).has_value() ||
                next_possible_duration(rest, least * (1 + 1e-9)) > least)
        << text(task);
    const double asked = least * (1 + cases.unit());
    if (move_of_duration(rest, asked)) continue;
    ++gaps;
    const double next = next_possible_duration(rest, asked);
    ASSERT_TRUE(move_of_duration(rest, next * (1 + 1e-12)).has_value()) << text(task) << " in " << next;
    for (double share : {0.1, 0.3, 0.5, 0.7, 0.9, 0.999}) {
      const double between = asked + share * (next - asked);
      ASSERT_FALSE(move_of_duration(rest, between).has_value()) << text(task) << " in " << between;
    }
  }
  EXPECT_GT(gaps, 500);
}

TEST(SynchronizedMotion, ChangesVelocityAtOnceAsFastAsOneAxisCould) {
  MotionCases cases{24};
  for (int i = 0; i < 20'000; ++i) {
    const std::size_t axes = 1 + static_cast<std::size_t>(cases.unit() * 7);
    std::vector<AxisTask> tasks = random_axes(cases, axes, 6.0);
    if (i % 10 == 0) tasks[0] = cases.beyond();
    std::vector<AxisTrajectory> moves(axes);
    ASSERT_EQ(plan_velocities(tasks, moves, Synchronization::none).error, TrajectoryError::none);
    for (std::size_t k = 0; k < axes; ++k) {
      const AxisTask& task = tasks[k];
      ASSERT_EQ(fault_of_change(task, moves[k]), "") << text(task);
      if (task.limits.acceleration_max != -task.limits.acceleration_min) continue;
      const VelocityPlan alone = plan_velocity(task.start, task.target.velocity, task.target.acceleration,
                                               {task.limits.acceleration_max, task.limits.jerk});
      // Rounding of the velocities, e, costs up to sqrt(e / jmax) seconds.
      const double rounding =
          8 * std::sqrt(1e-15 * (std::abs(task.start.velocity) + std::abs(task.target.velocity)) / task.limits.jerk);
      const double duration = alone.trajectory.duration();
      ASSERT_NEAR(moves[k].duration(), duration, 1e-12 * duration + rounding) << text(task);
    }
    const MotionPlan together = plan_velocities(tasks, moves, Synchronization::time);
    ASSERT_EQ(together.error, TrajectoryError::none);
    for (std::size_t k = 0; k < axes; ++k) {
      ASSERT_NEAR(moves[k].duration(), together.duration, 1e-12 * together.duration);
      ASSERT_EQ(fault_of_change(tasks[k], moves[k]), "") << text(tasks[k]) << " in " << together.duration;
    }
  }
}

TEST(SynchronizedMotion, StretchesTimeItselfFromRestToRest) {
  std::array<AxisTask, 3> tasks;
  tasks[0] = {{}, {100.0, 0.0, 0.0}, symmetric_limits(10.0, 2.0, 4.0)};
  tasks[1] = {{}, {-1.0, 0.0, 0.0}, {1.0, -2.0, 3.0, -0.5, 1.0}};
  tasks[2] = {{5.0, 0.0, 0.0}, {5.0, 0.0, 0.0}, {1.0, -2.0, 3.0, -0.5, 1.0}};
  std::array<AxisTrajectory, 3> moves;
  const MotionPlan plan = plan_positions(tasks, moves, Synchronization::time);
  ASSERT_EQ(plan.error, TrajectoryError::none);
  const AxisTrajectory alone = plan_position(tasks[1].start, tasks[1].target, tasks[1].limits).trajectory;
  for (double share = 0.0; share <= 1.0; share += 1.0 / 64) {
    EXPECT_NEAR(moves[1].at(share * plan.duration).position, alone.at(share * alone.duration()).position, 1e-14);
    EXPECT_EQ(moves[2].at(share * plan.duration).position, 5.0) << "what is there already does not move";
  }
}

// No input makes it hang, and what has no answer in doubles says so.
TEST(SynchronizedMotion, EndsForAnyNumbers) {
  std::mt19937_64 random{25};
  const auto any = [&]() -> double {
    if (random() % 6 == 0) return 0.0;
    const int reach = random() % 2 == 0 ? 30 : 1000;
    const double mantissa = 1.0 + static_cast<double>(random() % 1000) / 1000.0;
    return std::ldexp(random() % 2 == 0 ? mantissa : -mantissa, static_cast<int>(random() % (2 * reach)) - reach);
  };
  int planned = 0;
  for (int i = 0; i < 50'000; ++i) {
    std::vector<AxisTask> tasks(1 + random() % 3);
    for (AxisTask& task : tasks) {
      task.start = {any(), any(), any()};
      task.target = {any(), random() % 2 == 0 ? any() : 0.0, random() % 2 == 0 ? any() : 0.0};
      task.limits = {std::abs(any()), -std::abs(any()), std::abs(any()), -std::abs(any()), std::abs(any())};
    }
    std::vector<AxisTrajectory> moves(tasks.size());
    for (auto plan : {plan_positions, plan_velocities}) {
      const MotionPlan found = plan(tasks, moves, Synchronization::time);
      if (found.error != TrajectoryError::none) continue;
      ASSERT_TRUE(found.duration >= 0 && std::isfinite(found.duration)) << text(tasks[0]);
      ++planned;
    }
  }
  EXPECT_GT(planned, 5'000);
}

TEST(SynchronizedMotion, ReturnsWhichAxisIsImpossible) {
  std::array<AxisTask, 3> tasks;
  for (AxisTask& task : tasks) task = {{}, {1.0, 0.0, 0.0}, symmetric_limits(1.0, 1.0, 1.0)};
  std::array<AxisTrajectory, 3> moves;
  EXPECT_EQ(plan_positions(tasks, std::span(moves).first(2), Synchronization::time).error,
            TrajectoryError::sizes_differ);
  EXPECT_EQ(plan_positions(tasks, moves, Synchronization::time).error, TrajectoryError::none);
  tasks[2].target.velocity = 2.0;
  const MotionPlan plan = plan_positions(tasks, moves, Synchronization::time);
  EXPECT_EQ(plan.error, TrajectoryError::target_velocity_beyond_limit);
  EXPECT_EQ(plan.axis, 2U);
  EXPECT_EQ(plan_velocities(tasks, moves, Synchronization::time).error, TrajectoryError::none);
}

}  // namespace
}  // namespace stillcut
