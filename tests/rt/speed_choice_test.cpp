#include "rt/speed_choice.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "dsp/numbers.hpp"
#include "tests/rt/monitor_script.hpp"
#include "tests/rt/speed_cases.hpp"

namespace stillcut {
namespace {

class RandomSpeeds : public ::testing::Test {
 protected:
  SpeedCase next() { return random_speed_case(cases_); }

  ChoiceCases cases_{20250612};
};

TEST_F(RandomSpeeds, TargetMayBeAskedForAndIsNotPredictedWorse) {
  int found = 0, limited = 0;
  for (int i = 0; i < 4000; ++i) {
    const SpeedCase c = next();
    const SpeedChoice choice = choose_speed(c.question(), c.limits);
    if (!choice.found()) continue;
    ++found;
    const Prediction p = c.kept.view();
    EXPECT_TRUE(spindle_may_stay(c.limits, choice.target));
    EXPECT_TRUE(tooth_may_take(c.limits, choice.target, c.programmed_speed));
    EXPECT_GE(std::abs(choice.target - c.speed), 0.005 * c.speed);
    for (const double t : c.tried) EXPECT_GE(std::abs(t - choice.target), 0.01 * choice.target);
    const double before = margin_at(p, c.speed), after = margin_at(p, choice.target);
    EXPECT_FALSE(after <= before) << before << " to " << after;
    EXPECT_TRUE(choice.margin_before == before || (std::isnan(choice.margin_before) && std::isnan(before)));
    EXPECT_TRUE(choice.margin_after == after || (std::isnan(choice.margin_after) && std::isnan(after)));
    const double override_there = choice.target / c.programmed_speed;
    const bool held_up = override_there < c.limits.min_feed_override || override_there > c.limits.max_feed_override;
    EXPECT_EQ(choice.limited_by, held_up ? kLimitedByFeedRange : 0);
    limited += held_up ? 1 : 0;
    EXPECT_NEAR(choice.move_s, fastest_move_s(c, choice.target), 1e-9 + 1e-9 * choice.move_s);
    EXPECT_GT(choice.confidence_percent, 0);
    EXPECT_LE(choice.confidence_percent, 100);
  }
  EXPECT_GT(found, 2000);
  EXPECT_GT(limited, 20);
}

TEST_F(RandomSpeeds, GroundsMeanWhatTheySay) {
  int seen[5] = {};
  for (int i = 0; i < 4000; ++i) {
    const SpeedCase c = next();
    const SpeedChoice choice = choose_speed(c.question(), c.limits);
    ++seen[static_cast<int>(choice.grounds)];
    const double safe = safe_margin_at(c.kept.view(), choice.target);
    const double n_k = choice.lobe > 0 ? c.in_step(choice.lobe) : kNaN;
    switch (choice.grounds) {
      case SpeedGrounds::agreed:
        ASSERT_GE(choice.lobe, 1);
        EXPECT_GT(safe, 0.0);
        EXPECT_LE(std::abs(choice.target - n_k), std::min(0.01, 0.2 / choice.lobe) * n_k * (1.0 + 1e-9));
        break;
      case SpeedGrounds::predicted:
        EXPECT_EQ(choice.lobe, 0);
        EXPECT_GT(safe, 0.0);
        EXPECT_TRUE(heard_is_known(c));
        break;
      case SpeedGrounds::in_step:
        ASSERT_GE(choice.lobe, 1);
        EXPECT_NEAR(choice.target, n_k, 1e-12 * n_k);
        EXPECT_TRUE(std::isnan(safe) || !heard_is_known(c));
        break;
      case SpeedGrounds::improved:
        EXPECT_FALSE(choice.margin_after <= choice.margin_before);
        EXPECT_EQ(choice.confidence_percent, 30);
        break;
      case SpeedGrounds::none:
        break;
    }
  }
  for (const int count : seen) EXPECT_GT(count, 25);
}

TEST_F(RandomSpeeds, ASafeSpeedInStepIsTakenAndNothingBesideIt) {
  int safe_ones = 0, beside = 0;
  for (int i = 0; i < 4000; ++i) {
    const SpeedCase c = next();
    const SpeedChoice choice = choose_speed(c.question(), c.limits);
    std::vector<double> safe = lobes_in_reach(c);
    std::erase_if(safe, [&](double speed) { return !is_safe(c, speed); });
    if (!safe.empty()) {
      ++safe_ones;
      ASSERT_EQ(choice.grounds, SpeedGrounds::agreed);
    }
    if (choice.grounds != SpeedGrounds::agreed) continue;
    const double n_k = c.in_step(choice.lobe);
    const bool is_n_k = std::abs(choice.target - n_k) < 1e-12 * n_k;
    beside += is_n_k ? 0 : 1;
    if (!is_n_k) {
      EXPECT_FALSE(may_choose(c, n_k, 0.01) && is_safe(c, n_k));
    }
  }
  EXPECT_GT(safe_ones, 250);
  EXPECT_GT(beside, 25);
}

TEST_F(RandomSpeeds, NothingWithBetterGroundsIsLeft) {
  int predicted = 0, in_step = 0;
  for (int i = 0; i < 4000; ++i) {
    const SpeedCase c = next();
    const SpeedChoice choice = choose_speed(c.question(), c.limits);
    const std::vector<double> points = points_in_reach(c), lobes = lobes_in_reach(c);
    if (heard_is_known(c) && std::any_of(points.begin(), points.end(), [&](double p) { return is_safe(c, p); })) {
      ++predicted;
      EXPECT_GE(choice.grounds, SpeedGrounds::predicted);
    }
    const auto nothing_against = [&](double n) {
      return std::isnan(safe_margin_at(c.kept.view(), n)) || !heard_is_known(c);
    };
    if (std::any_of(lobes.begin(), lobes.end(), nothing_against)) {
      ++in_step;
      EXPECT_GE(choice.grounds, SpeedGrounds::in_step);
    }
  }
  EXPECT_GT(predicted, 250);
  EXPECT_GT(in_step, 250);
}

TEST_F(RandomSpeeds, AmongEqualGroundsTheVibrationIsSoonestOver) {
  int agreed = 0, predicted = 0;
  for (int i = 0; i < 4000; ++i) {
    const SpeedCase c = next();
    const SpeedChoice choice = choose_speed(c.question(), c.limits);
    if (!choice.found()) continue;
    EXPECT_NEAR(choice.decay_s, decay_s(c, choice.target), 0.002 * choice.decay_s);
    if (choice.grounds != SpeedGrounds::agreed && choice.grounds != SpeedGrounds::predicted) continue;
    const bool of_lobe = choice.grounds == SpeedGrounds::agreed;
    ++(of_lobe ? agreed : predicted);
    for (const double other : of_lobe ? lobes_in_reach(c) : points_in_reach(c)) {
      if (!is_safe(c, other)) continue;
      EXPECT_LE(choice.move_s + choice.decay_s, (fastest_move_s(c, other) + decay_s(c, other)) * 1.002);
    }
  }
  EXPECT_GT(agreed, 250);
  EXPECT_GT(predicted, 100);
}

TEST_F(RandomSpeeds, WithoutADiagramTheSoonestReachedInStepIsChosen) {
  int found = 0;
  for (int i = 0; i < 2000; ++i) {
    SpeedCase c = next();
    c.kept = {};
    const std::vector<double> lobes = lobes_in_reach(c);
    const SpeedChoice choice = choose_speed(c.question(), c.limits);
    ASSERT_EQ(choice.found(), !lobes.empty());
    if (lobes.empty()) continue;
    ++found;
    EXPECT_EQ(choice.grounds, SpeedGrounds::in_step);
    for (const double other : lobes) EXPECT_LE(choice.move_s, fastest_move_s(c, other) * (1.0 + 1e-9));
    EXPECT_TRUE(std::isnan(choice.margin_before));
    EXPECT_TRUE(std::isnan(choice.margin_after));
    EXPECT_TRUE(std::isnan(choice.safe_margin));
  }
  EXPECT_GT(found, 250);
}

TEST_F(RandomSpeeds, WithoutALineOnlyTheLobesAnswer) {
  int found = 0;
  for (int i = 0; i < 2000; ++i) {
    SpeedCase c = next();
    c.chatter_frequency_hz = kNaN;
    const SpeedChoice choice = choose_speed(c.question(), c.limits);
    if (!c.kept.here) {
      EXPECT_FALSE(choice.found());
    }
    if (!choice.found()) continue;
    ++found;
    EXPECT_EQ(choice.lobe, 0);
    EXPECT_NE(choice.grounds, SpeedGrounds::in_step);
    EXPECT_NE(choice.grounds, SpeedGrounds::agreed);
    const std::vector<double> points = points_in_reach(c);
    EXPECT_NE(std::find(points.begin(), points.end(), choice.target), points.end());
  }
  EXPECT_GT(found, 250);
}

TEST_F(RandomSpeeds, WhereNothingMayBeChosenItSaysSo) {
  int none = 0;
  for (int i = 0; i < 4000; ++i) {
    const SpeedCase c = next();
    const SpeedChoice choice = choose_speed(c.question(), c.limits);
    // Without a prediction that calls the target safe or better only a speed in step may be asked for.
    const double before = margin_at(c.kept.view(), c.speed);
    const auto gains = [&](double speed) {
      const double safe = safe_margin_at(c.kept.view(), speed);
      return safe > 0.0 || safe - before > 0.1;
    };
    const std::vector<double> points = points_in_reach(c), lobes = lobes_in_reach(c);
    const bool any_lobe = std::any_of(lobes.begin(), lobes.end(), [&](double n) {
      return gains(n) || std::isnan(safe_margin_at(c.kept.view(), n)) || !heard_is_known(c);
    });
    const bool any = any_lobe || std::any_of(points.begin(), points.end(), gains);
    if (any) {
      EXPECT_TRUE(choice.found());
      EXPECT_EQ(choice.limited_by & kNoStableSettingKnown, 0);
    }
    if (choice.found()) continue;
    ++none;
    EXPECT_FALSE(any);
    EXPECT_EQ(choice.limited_by, kNoStableSettingKnown | kLimitedBySpeedRange);
    EXPECT_EQ(choice.confidence_percent, 0);
  }
  EXPECT_GT(none, 200);
}

TEST(SpeedChoice, QuestionsWithoutAnAnswerAreToldNotComputed) {
  CompensationLimits limits;
  limits.spindle = {rpm_to_rad_s(6000), rpm_to_rad_s(12000), 300, 3000};
  const double speed = rpm_to_rad_s(9000);
  const SpeedQuestion good{750.0, 750.0, 2, speed, speed, {}, {}};
  ASSERT_TRUE(choose_speed(good, limits).found());
  std::vector<SpeedQuestion> bad(11, good);
  bad[0].chatter_frequency_hz = kNaN;
  bad[1].chatter_frequency_hz = kInfinity;
  bad[2].chatter_frequency_hz = 0.0;
  bad[3].chatter_frequency_hz = -750.0;
  bad[4].chatter_frequency_hz = 1e300;
  bad[5].teeth = 0;
  bad[6].teeth = -2;
  bad[7].speed = kNaN;
  bad[8].speed = 0.0;
  bad[9].programmed_speed = kNaN;
  bad[10].programmed_speed = 0.0;
  std::vector<CompensationLimits> impossible(4, limits);
  impossible[0].spindle = {};
  impossible[1].spindle.max_speed = kNaN;
  impossible[2].spindle.acceleration = 0.0;
  impossible[3].spindle.jerk = kNaN;
  for (std::size_t i = 0; i < bad.size() + impossible.size(); ++i) {
    const SpeedChoice choice =
        i < bad.size() ? choose_speed(bad[i], limits) : choose_speed(good, impossible[i - bad.size()]);
    EXPECT_FALSE(choice.found()) << i;
    EXPECT_NE(choice.limited_by & kNoStableSettingKnown, 0) << i;
  }
}

// 738 Hz, two teeth: 7380 and 11070 rpm are in step, and 7380 is nearer to 9000.
TEST(SpeedChoice, TheExampleOfTheDocumentation) {
  CompensationLimits limits;
  limits.spindle = spindle_6000_to_12000();
  const SpeedChoice choice = choose_speed({738.0, 738.0, 2, rpm_to_rad_s(9000), rpm_to_rad_s(9000), {}, {}}, limits);
  EXPECT_EQ(choice.lobe, 3);
  EXPECT_NEAR(rad_s_to_rpm(choice.target), 7380.0, 1e-6);
  const double tried[] = {choice.target};
  const SpeedChoice second = choose_speed({738.0, 738.0, 2, rpm_to_rad_s(9000), rpm_to_rad_s(9000), {}, tried}, limits);
  EXPECT_NEAR(rad_s_to_rpm(second.target), 11070.0, 1e-6);
}

}  // namespace
}  // namespace stillcut
