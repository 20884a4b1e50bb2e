#include "rt/cut_setting.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "dsp/numbers.hpp"
#include "tests/rt/choice_cases.hpp"
#include "tests/rt/monitor_script.hpp"

namespace stillcut {
namespace {

CompensationLimits motion_limits() {
  CompensationLimits limits;
  limits.spindle = spindle_6000_to_12000();
  return limits;
}

CutSetting random_setting(ChoiceCases& cases, const CompensationLimits& limits) {
  CutSetting s;
  s.speed = cases.speed_in(limits);
  s.feed_factor = cases.chance(0.1) ? 0.0 : cases.between(0.3, 1.0);
  s.feed_direction = cases.between(-3.0, 3.0);
  if (cases.chance(0.3)) s.variation_ratio = cases.between(0.05, 0.2), s.variation_hz = cases.between(0.2, 2.0);
  return s;
}

void expect_at(const CutSetting& now, const CutSetting& wanted) {
  EXPECT_EQ(now.speed, wanted.speed);
  EXPECT_EQ(now.feed_factor, wanted.feed_factor);
  EXPECT_EQ(now.feed_direction, wanted.feed_direction);
  EXPECT_EQ(now.variation_ratio, wanted.variation_ratio);
  EXPECT_EQ(now.variation_hz, wanted.variation_hz);
}

TEST(SettingMotion, RestsWhereItBegan) {
  SettingMotion motion;
  const CutSetting start{900.0, 0.1, 1.5, 0.8, -2.0};
  motion.begin(start);
  for (const double t : {0.0, 0.001, 1.0, 1e6}) {
    expect_at(motion.at(t).now, start);
    EXPECT_FALSE(motion.at(t).moving);
  }
}

// Sent to another setting again and again, most often in flight: between two looks nothing changes by more than its
// rate allows, nor does its rate by more than the rate's own; nor is anything left behind by the change of target.
TEST(SettingMotion, NothingJumpsNorExceedsItsRateHoweverOftenTheTargetChanges) {
  ChoiceCases cases{21};
  const CompensationLimits limits = motion_limits();
  constexpr double kLook_s = 0.004;
  for (int run = 0; run < 60; ++run) {
    SettingMotion motion;
    motion.begin(random_setting(cases, limits));
    CutSetting before = motion.at(0.0).now;
    double speed_rate = 0.0, t = 0.0;
    for (int change = 0; change < 8; ++change) {
      ASSERT_TRUE(motion.move_to(random_setting(cases, limits), t, limits, 1.0));
      EXPECT_NEAR(motion.at(t).now.speed, before.speed, 1e-9 * before.speed);
      EXPECT_NEAR(motion.at(t).now.feed_factor, before.feed_factor, 1e-9);
      EXPECT_NEAR(motion.at(t).now.feed_direction, before.feed_direction, 1e-9);
      for (int looks = cases.whole(1, 300); looks > 0; --looks) {
        t += kLook_s;
        const CutSetting now = motion.at(t).now;
        const double rate = (now.speed - before.speed) / kLook_s;
        EXPECT_LE(std::abs(rate), limits.spindle.acceleration * (1.0 + 1e-6));
        EXPECT_LE(std::abs(rate - speed_rate), limits.spindle.jerk * kLook_s * (1.0 + 1e-6));
        EXPECT_LE(std::abs(now.feed_factor - before.feed_factor), limits.feed_override_rate * kLook_s * (1.0 + 1e-6));
        EXPECT_LE(std::abs(now.feed_direction - before.feed_direction), limits.turn_rate * kLook_s * (1.0 + 1e-6));
        EXPECT_GE(now.speed, limits.spindle.min_speed * (1.0 - 1e-12));
        EXPECT_LE(now.speed, limits.spindle.max_speed * (1.0 + 1e-12));
        before = now;
        speed_rate = rate;
      }
    }
  }
}

TEST(SettingMotion, ArrivesExactlyWhenItSays) {
  ChoiceCases cases{22};
  const CompensationLimits limits = motion_limits();
  for (int run = 0; run < 300; ++run) {
    SettingMotion motion;
    motion.begin(random_setting(cases, limits));
    double t = 0.0;
    for (int change = cases.whole(1, 4); change > 0; --change) {
      ASSERT_TRUE(motion.move_to(random_setting(cases, limits), t, limits, cases.between(0.1, 1.0)));
      t += cases.between(0.0, 0.5);
    }
    const double arrives = motion.arrives_at();
    expect_at(motion.at(arrives + 1e-9).now, motion.target());
    expect_at(motion.at(arrives + 1e6).now, motion.target());
    EXPECT_FALSE(motion.at(arrives + 1e-9).moving);
    EXPECT_TRUE(motion.at(arrives - 1e-3).moving);
  }
}

TEST(SettingMotion, TheVariationSetsInWhenItsMeanIsReachedAndEndsWithTheNextMove) {
  const CompensationLimits limits = motion_limits();
  SettingMotion motion;
  motion.begin({rpm_to_rad_s(9000), 0.0, 0.0, 1.0, 0.0});
  const CutSetting swing{rpm_to_rad_s(10500), 0.15, 1.2, 1.0, 2.0};  // the turn takes far longer than the speed
  ASSERT_TRUE(motion.move_to(swing, 0.0, limits, 1.0));
  bool before = true;
  for (double t = 0.0; t < motion.arrives_at() + 0.1; t += 0.001) {
    const CutSetting now = motion.at(t).now;
    if (now.speed != swing.speed) {
      EXPECT_TRUE(before);
      EXPECT_EQ(now.variation_ratio, 0.0);
      EXPECT_EQ(now.variation_hz, 0.0);
    } else {
      before = false;
      EXPECT_EQ(now.variation_ratio, 0.15);
      EXPECT_EQ(now.variation_hz, 1.2);
    }
  }
  const double t = motion.arrives_at() + 1.0;
  ASSERT_TRUE(motion.move_to({rpm_to_rad_s(9000), 0.0, 0.0, 1.0, 0.0}, t, limits, 1.0));
  EXPECT_EQ(motion.at(t).now.variation_ratio, 0.0);
  EXPECT_EQ(motion.at(t).now.speed, swing.speed);
}

TEST(SettingMotion, ALowerPaceTakesLongerAndKeepsToLowerRates) {
  ChoiceCases cases{23};
  const CompensationLimits limits = motion_limits();
  for (int run = 0; run < 200; ++run) {
    const CutSetting from = random_setting(cases, limits), to = random_setting(cases, limits);
    double arrived = 0.0;
    for (const double pace : {1.0, 0.5, 0.2}) {
      SettingMotion motion;
      motion.begin(from);
      ASSERT_TRUE(motion.move_to(to, 0.0, limits, pace));
      EXPECT_GT(motion.arrives_at(), arrived);
      arrived = motion.arrives_at();
      CutSetting before = from;
      for (double t = 0.01; t < arrived; t += 0.01) {
        const CutSetting now = motion.at(t).now;
        EXPECT_LE(std::abs(now.speed - before.speed), pace * limits.spindle.acceleration * 0.01 * (1.0 + 1e-6));
        EXPECT_LE(std::abs(now.feed_factor - before.feed_factor), pace * limits.feed_override_rate * 0.01 * 1.000001);
        EXPECT_LE(std::abs(now.feed_direction - before.feed_direction), pace * limits.turn_rate * 0.01 * 1.000001);
        before = now;
      }
    }
  }
}

// A gentle return may be asked for while the spindle still speeds up towards the end of its range, or the feed still
// turns towards the end of its freedom.
TEST(SettingMotion, ALowerPaceInFlightRunsNoFurtherThanTheTargetItHad) {
  ChoiceCases cases{24};
  const CompensationLimits limits = motion_limits();
  for (int run = 0; run < 300; ++run) {
    const CutSetting from = random_setting(cases, limits), to = random_setting(cases, limits);
    SettingMotion motion;
    motion.begin(from);
    ASSERT_TRUE(motion.move_to(to, 0.0, limits, 1.0));
    const double turns_back = cases.between(0.0, motion.arrives_at());
    ASSERT_TRUE(motion.move_to(from, turns_back, limits, cases.between(0.05, 0.5)));
    const auto is_between = [](double now, double a, double b) {
      return now >= std::min(a, b) - 1e-9 * (1.0 + std::abs(a)) && now <= std::max(a, b) + 1e-9 * (1.0 + std::abs(a));
    };
    for (double t = turns_back; t < motion.arrives_at(); t += 0.01) {
      const CutSetting now = motion.at(t).now;
      ASSERT_TRUE(is_between(now.speed, from.speed, to.speed)) << turns_back;
      ASSERT_TRUE(is_between(now.feed_factor, from.feed_factor, to.feed_factor)) << turns_back;
      ASSERT_TRUE(is_between(now.feed_direction, from.feed_direction, to.feed_direction)) << turns_back;
    }
  }
}

TEST(SettingMotion, AnImpossibleMoveLeavesTheOldOneGoingOn) {
  const CompensationLimits limits = motion_limits();
  const CutSetting from{rpm_to_rad_s(9000), 0.0, 0.0, 1.0, 0.0}, to{rpm_to_rad_s(7000), 0.1, 1.0, 0.5, 1.0};
  SettingMotion motion, undisturbed;
  for (SettingMotion* m : {&motion, &undisturbed}) {
    m->begin(from);
    ASSERT_TRUE(m->move_to(to, 0.0, limits, 1.0));
  }
  for (int bad = 0; bad < 6; ++bad) {
    CutSetting impossible = from;
    CompensationLimits without = limits;
    if (bad == 0) impossible.speed = kNaN;
    if (bad == 1) impossible.feed_factor = kInfinity;
    if (bad == 2) impossible.feed_direction = kNaN;
    if (bad == 3) without.spindle.jerk = 0.0;
    if (bad == 4) without.turn_rate = 0.0;
    EXPECT_FALSE(motion.move_to(impossible, 0.1, without, bad == 5 ? 0.0 : 1.0)) << bad;
  }
  for (double t = 0.0; t < undisturbed.arrives_at() + 0.1; t += 0.01)
    expect_at(motion.at(t).now, undisturbed.at(t).now);
  EXPECT_EQ(motion.arrives_at(), undisturbed.arrives_at());
}

}  // namespace
}  // namespace stillcut
