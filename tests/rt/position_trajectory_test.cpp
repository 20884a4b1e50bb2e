#include "rt/position_trajectory.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "dsp/numbers.hpp"
#include "tests/rt/motion_cases.hpp"

namespace stillcut {
namespace {

PositionPlan plan(const AxisTask& task) { return plan_position(task.start, task.target, task.limits); }

struct ReferenceMove {
  std::string line;
  AxisTask task;
  double duration = 0.0, brake = 0.0;
};

std::vector<ReferenceMove> reference_moves() {
  std::ifstream table{TEST_DATA "/trajectory/position.csv"};
  std::vector<ReferenceMove> rows;
  std::string line;
  std::getline(table, line);
  EXPECT_EQ(line, "stratum,p0,v0,a0,pf,vf,af,vmax,amax,jmax,duration,brake_duration");
  while (std::getline(table, line)) {
    ReferenceMove row{line, {}, 0.0, 0.0};
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream fields{line};
    std::string stratum;
    double v = 0.0, a = 0.0, j = 0.0;
    MotionState &s = row.task.start, &t = row.task.target;
    fields >> stratum >> s.position >> s.velocity >> s.acceleration >> t.position >> t.velocity >> t.acceleration >>
        v >> a >> j >> row.duration >> row.brake;
    EXPECT_TRUE(fields) << line;
    row.task.limits = symmetric_limits(v, a, j);
    rows.push_back(row);
  }
  return rows;
}

TEST(PositionTrajectory, MatchesTheReferenceDurations) {
  int rows = 0, equal = 0, braked = 0;
  for (const ReferenceMove& row : reference_moves()) {
    const PositionPlan found = plan(row.task);
    ASSERT_EQ(found.error, TrajectoryError::none) << row.line;
    EXPECT_EQ(fault_of(row.task, found.trajectory), "") << row.line;
    const double duration = found.trajectory.duration();
    if (row.brake > 0) {
      ++braked;
      EXPECT_LE(duration, row.duration * (1 + 1e-9)) << row.line;
      EXPECT_GT(found.trajectory.brake_duration(), 0.0) << row.line;
    } else {
      ++rows;
      EXPECT_LE(duration, row.duration * (1 + 1e-6)) << row.line;
      equal += std::abs(duration - row.duration) <= 1e-9 * row.duration ? 1 : 0;
    }
  }
  EXPECT_EQ(rows, 1643);
  EXPECT_EQ(braked, 357);
  EXPECT_GE(equal, 0.999 * rows);
}

TEST(PositionTrajectory, IsSevenPhasesByHand) {
  // From rest to rest at vmax 10, amax 2, jmax 4: 5.5 s to full speed over 27.5, 2 s of cruise, 5.5 s back.
  const PositionPlan found = plan_position({}, {75.0, 0.0, 0.0}, symmetric_limits(10.0, 2.0, 4.0));
  ASSERT_EQ(found.error, TrajectoryError::none);
  EXPECT_DOUBLE_EQ(found.trajectory.duration(), 13.0);
  EXPECT_EQ(found.trajectory.phase_count(), 7U);
  EXPECT_DOUBLE_EQ(found.trajectory.at(0.5).acceleration, 2.0);
  EXPECT_DOUBLE_EQ(found.trajectory.at(6.5).velocity, 10.0);
  EXPECT_DOUBLE_EQ(found.trajectory.at(6.5).position, 37.5);
  EXPECT_EQ(found.trajectory.at(13.0).position, 75.0);
  // Four jerk phases alone: T^3 = 32 d / j.
  const PositionPlan short_one = plan_position({}, {1.0, 0.0, 0.0}, symmetric_limits(10.0, 2.0, 0.5));
  EXPECT_NEAR(short_one.trajectory.duration(), 4.0, 1e-15);
}

TEST(PositionTrajectory, IsValidAndTakesAsLongBackwardsAndMirrored) {
  MotionCases cases{11};
  for (int i = 0; i < 100'000; ++i) {
    const AxisTask task = cases.next();
    const PositionPlan forward = plan(task);
    ASSERT_EQ(forward.error, TrajectoryError::none) << text(task);
    ASSERT_EQ(fault_of(task, forward.trajectory), "") << text(task);
    ASSERT_EQ(forward.trajectory.brake_duration(), 0.0) << text(task);
    const double duration = forward.trajectory.duration();
    const PositionPlan backward = plan(reversed(task));
    ASSERT_NEAR(backward.trajectory.duration(), duration, 1e-10 * duration) << text(task);
    AxisTask mirrored = reversed(task);
    mirrored.start = {-task.start.position, -task.start.velocity, -task.start.acceleration};
    mirrored.target = {-task.target.position, -task.target.velocity, -task.target.acceleration};
    mirrored.limits.acceleration_max = -task.limits.acceleration_min;
    mirrored.limits.acceleration_min = -task.limits.acceleration_max;
    ASSERT_NEAR(plan(mirrored).trajectory.duration(), duration, 1e-10 * duration) << text(task);
  }
}

// Throwing a ball up: at the limit all the time, and far too short to change that.
TEST(PositionTrajectory, IsPreciseWhereShortBesideItsAcceleration) {
  MotionCases cases{17};
  for (int i = 0; i < 20'000; ++i) {
    const double a = cases.scale(2.0), jerk = cases.scale(2.0), share = 0.05 * std::pow(10.0, -5.0 * cases.unit());
    const double v = share * a * a / jerk;
    const AxisTask task{{0.0, v, -a}, {0.0, -v, -a}, symmetric_limits(1e3 * a * a / jerk, a, jerk)};
    const PositionPlan found = plan(task);
    ASSERT_EQ(fault_of(task, found.trajectory), "") << text(task);
    ASSERT_NEAR(found.trajectory.duration(), 2 * v / a, 1e-9 * v / a) << text(task);
  }
}

// Whatever admissible move is made at random, the plan to where it ended is not longer.
TEST(PositionTrajectory, NoMoveFoundAtRandomIsShorter) {
  MotionCases cases{12};
  int planned = 0, as_long = 0;
  while (planned < 50'000) {
    AxisTask task = cases.next();
    task.start.position = 0.0;
    const AxisLimits& l = task.limits;
    const double scale = std::min({l.acceleration_max / l.jerk, std::sqrt(l.velocity_max / l.jerk)}) * cases.scale(1.0);
    const bool bang_bang = cases.one_in(2);
    const double side = cases.one_in(2) ? 1.0 : -1.0;
    AxisTrajectory made;
    made.begin(task.start);
    constexpr double kPattern[] = {1.0, 0.0, -1.0, 0.0, 1.0};
    for (double pattern : kPattern) {
      const double t = bang_bang && pattern == 0.0 ? 0.0 : scale * cases.unit();
      const double jerk = l.jerk * (bang_bang ? side * pattern : cases.signed_unit());
      made.add(t, jerk, made.reached().acceleration + jerk * t);
    }
    task.target = made.reached();
    // What the acceleration adds to the velocity must be well above its rounding.
    if (largest_of(task, made).acceleration * made.duration() < 1e-8 * std::abs(task.start.velocity)) continue;
    if (check_task(task) != TrajectoryError::none || !fault_of(task, made).empty()) continue;
    const PositionPlan found = plan(task);
    ASSERT_EQ(found.error, TrajectoryError::none) << text(task);
    if (found.trajectory.brake_duration() > 0) continue;
    // Rounding of the target may cost the square root of it, and a detour where a ramp just fits: seldom.
    const double rounding = 1e-7;
    ASSERT_LE(found.trajectory.duration(), made.duration() * (1 + rounding)) << text(task);
    as_long += found.trajectory.duration() > made.duration() * (1 - rounding) ? 1 : 0;
    ++planned;
  }
  EXPECT_GT(as_long, planned / 10) << "many such moves are the fastest, else this proves little";
}

// Two independent solutions of one problem: the distance that the fastest change of velocity covers.
TEST(PositionTrajectory, IsTheFastestChangeOfVelocityOverItsOwnDistance) {
  MotionCases cases{13};
  for (int i = 0; i < 50'000; ++i) {
    AxisTask task = cases.next();
    task.limits.acceleration_min = -task.limits.acceleration_max;
    if (check_task(task) != TrajectoryError::none) continue;
    const AxisLimits& l = task.limits;
    if (std::abs(task.start.acceleration) > l.acceleration_max) continue;
    task.start.position = 0.0;
    const VelocityPlan change =
        plan_velocity(task.start, task.target.velocity, task.target.acceleration, {l.acceleration_max, l.jerk});
    // What the acceleration adds to the velocity must be well above its rounding.
    const double added = l.acceleration_max * change.trajectory.duration();
    if (added < 1e-5 * std::max(std::abs(task.start.velocity), std::abs(task.target.velocity))) continue;
    task.target.position = change.trajectory.at(change.trajectory.duration()).position;
    const PositionPlan found = plan(task);
    ASSERT_EQ(found.error, TrajectoryError::none);
    const double duration = change.trajectory.duration();
    // The distance is rounded; where it changes slowly with the duration, that is a square root of the rounding.
    ASSERT_NEAR(found.trajectory.duration(), duration, 1e-7 * duration) << text(task);
  }
}

TEST(PositionTrajectory, PlannedAgainInFlightGoesOnFromThereAndArrivesNoLater) {
  MotionCases cases{14};
  int later = 0;
  constexpr int kMoves = 50'000;
  for (int i = 0; i < kMoves; ++i) {
    const AxisTask task = cases.next();
    const AxisTrajectory first = plan(task).trajectory;
    AxisTask rest = task;
    const double t = cases.unit() * first.duration();
    rest.start = first.at(t);
    const PositionPlan second = plan(rest);
    ASSERT_EQ(second.error, TrajectoryError::none) << text(rest);
    ASSERT_EQ(second.trajectory.at(0.0).position, rest.start.position);
    ASSERT_EQ(second.trajectory.at(0.0).velocity, rest.start.velocity);
    ASSERT_EQ(second.trajectory.at(0.0).acceleration, rest.start.acceleration);
    ASSERT_EQ(fault_of(rest, second.trajectory), "") << text(rest);
    later += t + second.trajectory.duration() > first.duration() * (1 + 1e-6) ? 1 : 0;
  }
  // The state in flight is rounded; at scales millions apart that may ask for a detour to its last bit.
  EXPECT_LE(later, kMoves / 500);
}

TEST(PositionTrajectory, BringsAStartBeyondTheLimitsBackAndThenKeepsThem) {
  MotionCases cases{15};
  int braked = 0;
  for (int i = 0; i < 50'000; ++i) {
    const AxisTask task = cases.beyond();
    const PositionPlan found = plan(task);
    ASSERT_EQ(found.error, TrajectoryError::none) << text(task);
    ASSERT_EQ(fault_of(task, found.trajectory), "") << text(task);
    braked += found.trajectory.brake_duration() > 0 ? 1 : 0;
  }
  EXPECT_GT(braked, 20'000);
}

TEST(PositionTrajectory, StaysWhereItIsWhenThereIsNothingToDo) {
  const MotionState here{100.0, 0.0, 0.0};
  const PositionPlan found = plan_position(here, here, symmetric_limits(1.0, 1.0, 1.0));
  ASSERT_EQ(found.error, TrajectoryError::none);
  EXPECT_EQ(found.trajectory.duration(), 0.0);
  EXPECT_EQ(found.trajectory.at(0.0).position, 100.0);
  EXPECT_EQ(found.trajectory.at(5.0).position, 100.0);
  const MotionState moving{100.0, 0.5, 0.3};
  EXPECT_EQ(plan_position(moving, moving, symmetric_limits(1.0, 1.0, 1.0)).trajectory.duration(), 0.0);
  EXPECT_EQ(AxisTrajectory{}.at(1.0).position, 0.0);
}

TEST(PositionTrajectory, ReturnsWhyAMoveIsImpossible) {
  const AxisLimits limits = symmetric_limits(1.0, 1.0, 1.0);
  for (double bad : {kNaN, kInfinity, -kInfinity}) {
    for (double MotionState::*member : {&MotionState::position, &MotionState::velocity, &MotionState::acceleration}) {
      MotionState state;
      state.*member = bad;
      EXPECT_EQ(plan_position(state, {}, limits).error, TrajectoryError::not_finite);
      EXPECT_EQ(plan_position({}, state, limits).error, TrajectoryError::not_finite);
    }
    EXPECT_EQ(plan_position({}, {}, symmetric_limits(bad, 1, 1)).error, TrajectoryError::not_finite);
    EXPECT_EQ(plan_position({}, {}, symmetric_limits(1, bad, 1)).error, TrajectoryError::not_finite);
    EXPECT_EQ(plan_position({}, {}, symmetric_limits(1, 1, bad)).error, TrajectoryError::not_finite);
  }
  for (double bad : {0.0, -1.0}) {
    EXPECT_EQ(plan_position({}, {}, symmetric_limits(bad, 1, 1)).error, TrajectoryError::limit_not_positive);
    EXPECT_EQ(plan_position({}, {}, symmetric_limits(1, bad, 1)).error, TrajectoryError::limit_not_positive);
    EXPECT_EQ(plan_position({}, {}, symmetric_limits(1, 1, bad)).error, TrajectoryError::limit_not_positive);
  }
  EXPECT_EQ(plan_position({}, {1, 0, 1.5}, limits).error, TrajectoryError::target_beyond_limit);
  EXPECT_EQ(plan_position({}, {1, 1.5, 0}, limits).error, TrajectoryError::target_velocity_beyond_limit);
  EXPECT_EQ(plan_position({}, {1, 0.9, -1}, limits).error, TrajectoryError::target_velocity_beyond_limit);
  EXPECT_EQ(plan_position({}, {1, 0.9, 1}, limits).error, TrajectoryError::none);
  EXPECT_EQ(plan_position({}, {1e300, 0, 0}, symmetric_limits(1e-300, 1, 1)).error, TrajectoryError::out_of_range);
}

// Random and degenerate cases, many: STILLCUT_CAMPAIGN says how many (the test labelled `long`: ten million).
TEST(PositionTrajectory, NeverFailsInACampaign) {
  const char* asked = std::getenv("STILLCUT_CAMPAIGN");
  const long count = asked != nullptr ? std::strtol(asked, nullptr, 10) : 100'000;
  MotionCases cases{static_cast<std::uint64_t>(count)};
  double longest_error = 0.0;
  for (long i = 0; i < count; ++i) {
    const bool outside = i % 8 == 0;
    const AxisTask task = outside ? cases.beyond() : cases.next();
    const PositionPlan found = plan(task);
    ASSERT_EQ(found.error, TrajectoryError::none) << text(task);
    ASSERT_EQ(fault_of(task, found.trajectory), "") << text(task);
    if (outside) continue;
    const double duration = found.trajectory.duration(), backward = plan(reversed(task)).trajectory.duration();
    ASSERT_NEAR(backward, duration, 1e-9 * duration) << text(task);
    longest_error = std::max(longest_error, duration > 0 ? std::abs(backward - duration) / duration : 0.0);
  }
  RecordProperty("worst_difference_of_reversal", std::to_string(longest_error));
}

}  // namespace
}  // namespace stillcut
