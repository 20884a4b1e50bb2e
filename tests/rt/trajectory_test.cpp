#include "rt/trajectory.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <random>
#include <sstream>
#include <string>

#include "dsp/numbers.hpp"

namespace stillcut {
namespace {

struct PlanCase {
  MotionState start;
  double vf = 0.0, af = 0.0;
  MotionLimits limits;
};

VelocityPlan plan(const PlanCase& c) { return plan_velocity(c.start, c.vf, c.af, c.limits); }

std::string text(const PlanCase& c) {
  std::ostringstream out;
  out.precision(17);
  out << "v0 " << c.start.velocity << " a0 " << c.start.acceleration << " vf " << c.vf << " af " << c.af << " amax "
      << c.limits.acceleration << " jmax " << c.limits.jerk;
  return out.str();
}

// Every quantity at a scale of its own, 1e-6 to 1e6; some starts, targets or both without acceleration.
class Cases {
 public:
  explicit Cases(std::uint64_t seed) : random_{seed} {}

  PlanCase next() {
    PlanCase c;
    c.limits = {scale(), scale()};
    c.start = {signed_unit(), scale() * signed_unit(), c.limits.acceleration * signed_unit()};
    c.vf = scale() * signed_unit();
    c.af = c.limits.acceleration * signed_unit();
    if (random_() % 3 == 0) c.start.acceleration = 0.0;
    if (random_() % 3 == 0) c.af = 0.0;
    if (random_() % 8 == 0) c.vf = c.start.velocity;
    if (random_() % 8 == 0) c.start.acceleration = std::copysign(c.limits.acceleration, signed_unit());
    return c;
  }
  double unit() { return std::uniform_real_distribution<double>{0.0, 1.0}(random_); }
  double signed_unit() { return 2.0 * unit() - 1.0; }
  double scale() { return std::pow(10.0, 6.0 * signed_unit()); }

 private:
  std::mt19937_64 random_;
};

// The largest velocity that a double of this move can be asked to resolve.
double velocity_scale(const PlanCase& c, double duration) {
  return std::abs(c.start.velocity) + std::abs(c.vf) +
         std::max(c.limits.acceleration, std::abs(c.start.acceleration)) * duration;
}

TEST(VelocityTrajectory, MatchesTheReferenceDurations) {
  std::ifstream table{TEST_DATA "/trajectory/velocity.csv"};
  std::string line;
  std::getline(table, line);
  ASSERT_EQ(line, "v0,a0,vf,af,amax,jmax,duration,brake_duration");
  int rows = 0, equal = 0, braked = 0;
  while (std::getline(table, line)) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream row{line};
    PlanCase c;
    double duration = 0.0, brake = 0.0;
    row >> c.start.velocity >> c.start.acceleration >> c.vf >> c.af >> c.limits.acceleration >> c.limits.jerk >>
        duration >> brake;
    ASSERT_TRUE(row) << line;
    const VelocityPlan found = plan(c);
    ASSERT_EQ(found.error, TrajectoryError::none) << line;
    EXPECT_LE(found.trajectory.duration(), duration * (1 + 1e-6)) << line;
    if (brake > 0) {
      ++braked;
      EXPECT_GT(found.trajectory.brake_duration(), 0.0) << line;
    } else {
      ++rows;
      equal += std::abs(found.trajectory.duration() - duration) <= 1e-9 * duration ? 1 : 0;
    }
  }
  EXPECT_EQ(rows, 480);
  EXPECT_EQ(braked, 20);
  EXPECT_GE(equal, 0.999 * rows);
}

TEST(VelocityTrajectory, IsAnAccelerationTrapezeByHand) {
  // 0 to 10 at amax 2, jmax 4: 0.5 s to the limit (adds 0.5), 4.5 s at it, 0.5 s back.
  const VelocityPlan found = plan_velocity({}, 10.0, 0.0, {2.0, 4.0});
  ASSERT_EQ(found.error, TrajectoryError::none);
  EXPECT_DOUBLE_EQ(found.trajectory.duration(), 5.5);
  EXPECT_DOUBLE_EQ(found.trajectory.at(0.5).velocity, 0.5);
  EXPECT_DOUBLE_EQ(found.trajectory.at(2.75).velocity, 5.0);
  EXPECT_DOUBLE_EQ(found.trajectory.at(2.75).acceleration, 2.0);
  EXPECT_DOUBLE_EQ(found.trajectory.at(5.0).velocity, 9.5);
  EXPECT_NEAR(found.trajectory.at(5.5).position, 27.5, 1e-12);  // symmetric: mean velocity 5
}

TEST(VelocityTrajectory, IsContinuousInsideItsLimitsAndReachesTheTarget) {
  Cases cases{1};
  for (int i = 0; i < 5'000; ++i) {
    PlanCase c = cases.next();
    if (i % 5 == 0) c.start.acceleration *= 1.0 + 10.0 * cases.unit();  // a start beyond the limit
    const VelocityPlan found = plan(c);
    ASSERT_EQ(found.error, TrajectoryError::none) << text(c);
    const VelocityTrajectory& move = found.trajectory;
    const double duration = move.duration(), v_scale = velocity_scale(c, duration);
    ASSERT_GE(duration, 0.0);
    constexpr int kSteps = 200;
    const double dt = duration / kSteps;
    MotionState before = move.at(0.0);
    ASSERT_EQ(before.velocity, c.start.velocity) << text(c);
    ASSERT_EQ(before.acceleration, c.start.acceleration) << text(c);
    for (int k = 1; k <= kSteps; ++k) {
      const MotionState now = move.at(k == kSteps ? duration : k * dt);
      const double limit = std::max(c.limits.acceleration, std::abs(c.start.acceleration));
      const double slack = 1e-9 * limit + 1e-12 * c.limits.jerk * duration;
      ASSERT_LE(std::abs(now.acceleration), limit + slack) << text(c);
      if (k * dt > move.brake_duration()) {
        ASSERT_LE(std::abs(now.acceleration), c.limits.acceleration + slack) << text(c);
      }
      // Between two instants no state can have gone further than its rate allows.
      ASSERT_LE(std::abs(now.acceleration - before.acceleration), c.limits.jerk * dt + slack) << text(c);
      ASSERT_LE(std::abs(now.velocity - before.velocity), limit * dt + 1e-9 * v_scale) << text(c);
      // Where the jerk is constant or changes within the step, the trapezoid rule errs by jerk dt^2 at most.
      ASSERT_NEAR(now.velocity - before.velocity, dt * (now.acceleration + before.acceleration) / 2,
                  c.limits.jerk * dt * dt + 1e-9 * v_scale)
          << text(c);
      before = now;
    }
    ASSERT_NEAR(before.velocity, c.vf, 1e-9 * v_scale) << text(c);
    ASSERT_EQ(before.acceleration, c.af) << text(c);
    // The last ramp arrives: no jump is hidden at the very end.
    const MotionState just_before = move.at(std::nextafter(duration, 0.0));
    ASSERT_NEAR(just_before.velocity, c.vf, 1e-9 * v_scale) << text(c);
    ASSERT_NEAR(just_before.acceleration, c.af, 1e-9 * c.limits.acceleration + 1e-12 * c.limits.jerk * duration)
        << text(c);
  }
}

TEST(VelocityTrajectory, PositionIsTheIntegralOfVelocity) {
  Cases cases{2};
  for (int i = 0; i < 1'000; ++i) {
    PlanCase c = cases.next();
    c.start.position = 0.0;
    const VelocityTrajectory move = plan(c).trajectory;
    const double duration = move.duration();
    // Gauss, two points a step: exact for a cubic, that is wherever the jerk does not change within the step.
    constexpr int kSteps = 2'000;
    const double dt = duration / kSteps;
    double integral = 0.0;
    for (int k = 0; k < kSteps; ++k) {
      for (double node : {-1.0, 1.0}) integral += dt / 2 * move.at(dt * (k + 0.5 + node / std::sqrt(12.0))).velocity;
    }
    const double scale = velocity_scale(c, duration) * duration;
    EXPECT_NEAR(move.at(duration).position, integral, 1e-9 * scale + 4 * c.limits.jerk * dt * dt * dt) << text(c);
  }
}

TEST(VelocityTrajectory, TakesAsLongBackwardsInTime) {
  Cases cases{3};
  for (int i = 0; i < 20'000; ++i) {
    const PlanCase c = cases.next();
    const PlanCase reversed{{0.0, c.vf, -c.af}, c.start.velocity, -c.start.acceleration, c.limits};
    const double forward = plan(c).trajectory.duration(), backward = plan(reversed).trajectory.duration();
    ASSERT_NEAR(forward, backward, 1e-12 * forward) << text(c);
  }
}

TEST(VelocityTrajectory, MirrorsWithTheSigns) {
  Cases cases{4};
  for (int i = 0; i < 2'000; ++i) {
    const PlanCase c = cases.next();
    const PlanCase mirrored{{0.0, -c.start.velocity, -c.start.acceleration}, -c.vf, -c.af, c.limits};
    const VelocityTrajectory a = plan(c).trajectory, b = plan(mirrored).trajectory;
    ASSERT_EQ(a.duration(), b.duration()) << text(c);
    const double t = cases.unit() * a.duration();
    ASSERT_NEAR(a.at(t).velocity, -b.at(t).velocity, 1e-14 * velocity_scale(c, a.duration())) << text(c);
  }
}

// An oracle that knows nothing of switching points: in time T, the highest gain of velocity is the area below
// min(a0 + j t, amax, af + j (T - t)), the lowest the area above its mirror image. Every gain between is possible, none
// outside.
double highest_gain(double a0, double af, double amax, double j, double duration) {
  constexpr int kSteps = 4'000;
  double area = 0.0;
  for (int k = 0; k < kSteps; ++k) {
    const double t = duration * (k + 0.5) / kSteps;
    area += std::min({a0 + j * t, amax, af + j * (duration - t)}) * duration / kSteps;
  }
  return area;
}

TEST(VelocityTrajectory, NoShorterMoveExists) {
  Cases cases{5};
  for (int i = 0; i < 300; ++i) {
    const PlanCase c = cases.next();
    const double a0 = c.start.acceleration, amax = c.limits.acceleration, j = c.limits.jerk;
    const double gain = c.vf - c.start.velocity;
    const double duration = plan(c).trajectory.duration();
    if (duration == 0.0) continue;
    const double rounding = 1e-14 * (std::abs(c.start.velocity) + std::abs(c.vf));
    const double least = std::abs(c.af - a0) / j;  // the change of acceleration alone takes this long
    const auto reachable = [&](double t) {
      const double slack = -1e-5 * (amax * t + std::abs(gain)) - rounding;  // the sum above is good to about 1e-7
      return gain <= highest_gain(a0, c.af, amax, j, t) + slack &&
             -gain <= highest_gain(-a0, -c.af, amax, j, t) + slack;
    };
    for (double part = 0.0; part < 0.999; part += 0.0625) {
      const double t = least + (duration - least) * part;
      ASSERT_FALSE(reachable(t)) << text(c) << ": " << t << " s instead of " << duration;
    }
    const double wider = -1e-5 * (amax * duration + std::abs(gain)) - rounding;
    ASSERT_LE(gain, highest_gain(a0, c.af, amax, j, duration) - wider) << text(c);
    ASSERT_LE(-gain, highest_gain(-a0, -c.af, amax, j, duration) - wider) << text(c);
  }
}

TEST(VelocityTrajectory, PlannedAgainInFlightGoesOnFromThereAndArrivesNoLater) {
  Cases cases{6};
  for (int i = 0; i < 20'000; ++i) {
    PlanCase c = cases.next();
    if (i % 2 == 0) c.af = 0.0;  // as the spindle does
    const VelocityTrajectory first = plan(c).trajectory;
    const double t = first.duration() * cases.unit();
    const MotionState there = first.at(t);
    const VelocityPlan second = plan_velocity(there, c.vf, c.af, c.limits);
    ASSERT_EQ(second.error, TrajectoryError::none) << text(c);
    ASSERT_EQ(second.trajectory.at(0.0).velocity, there.velocity);
    ASSERT_EQ(second.trajectory.at(0.0).acceleration, there.acceleration);
    // Rounding of the state in flight, e = 1e-16 of the velocity, costs up to sqrt(e / jmax) seconds near the end.
    const double rounding = 8 * std::sqrt(1e-15 * velocity_scale(c, first.duration()) / c.limits.jerk);
    ASSERT_LE(t + second.trajectory.duration(), first.duration() * (1 + 1e-9) + rounding) << text(c) << " t " << t;
  }
}

TEST(VelocityTrajectory, StaysWhereItIsWhenThereIsNothingToDo) {
  const VelocityPlan found = plan_velocity({3.0, 100.0, 0.0}, 100.0, 0.0, {1.0, 1.0});
  ASSERT_EQ(found.error, TrajectoryError::none);
  EXPECT_EQ(found.trajectory.duration(), 0.0);
  EXPECT_EQ(found.trajectory.at(2.0).velocity, 100.0);
  EXPECT_EQ(found.trajectory.at(2.0).position, 203.0);
  EXPECT_EQ(found.trajectory.at(-1.0).position, 3.0) << "before the start: the start";
  EXPECT_EQ(VelocityTrajectory{}.at(1.0).velocity, 0.0);
}

TEST(VelocityTrajectory, ReturnsWhyAMoveIsImpossible) {
  const MotionLimits limits{1.0, 1.0};
  for (double bad : {kNaN, kInfinity, -kInfinity}) {
    EXPECT_EQ(plan_velocity({bad, 0, 0}, 1, 0, limits).error, TrajectoryError::not_finite);
    EXPECT_EQ(plan_velocity({0, bad, 0}, 1, 0, limits).error, TrajectoryError::not_finite);
    EXPECT_EQ(plan_velocity({0, 0, bad}, 1, 0, limits).error, TrajectoryError::not_finite);
    EXPECT_EQ(plan_velocity({}, bad, 0, limits).error, TrajectoryError::not_finite);
    EXPECT_EQ(plan_velocity({}, 1, bad, limits).error, TrajectoryError::not_finite);
    EXPECT_EQ(plan_velocity({}, 1, 0, {bad, 1}).error, TrajectoryError::not_finite);
    EXPECT_EQ(plan_velocity({}, 1, 0, {1, bad}).error, TrajectoryError::not_finite);
  }
  for (double bad : {0.0, -0.0, -1.0}) {
    EXPECT_EQ(plan_velocity({}, 1, 0, {bad, 1}).error, TrajectoryError::limit_not_positive);
    EXPECT_EQ(plan_velocity({}, 1, 0, {1, bad}).error, TrajectoryError::limit_not_positive);
  }
  EXPECT_EQ(plan_velocity({}, 1, 1.5, limits).error, TrajectoryError::target_beyond_limit);
  EXPECT_EQ(plan_velocity({}, 1e300, 0, {1e-300, 1}).error, TrajectoryError::out_of_range);
  EXPECT_STRNE(describe(TrajectoryError::out_of_range), describe(TrajectoryError::not_finite));
}

}  // namespace
}  // namespace stillcut
