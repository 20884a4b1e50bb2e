#include "rt/correction_ladder.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "dsp/numbers.hpp"
#include "rt/direction_choice.hpp"
#include "tests/rt/monitor_script.hpp"
#include "tests/rt/speed_cases.hpp"

namespace stillcut {
namespace {

constexpr CorrectionKind kEveryAsk[] = {CorrectionKind::spindle_speed, CorrectionKind::speed_variation,
                                        CorrectionKind::feed_direction, CorrectionKind::feed_override,
                                        CorrectionKind::stop_request};

// A cut in which every rung has something to offer, the first three each a stable setting: 9000 rpm is unstable, a
// pocket lies from 10000 to 11000, a swing over the deep pocket beside is stable, and across the feed the robot is
// stiff.
class Ladder : public ::testing::Test {
 protected:
  Ladder() {
    limits.spindle = spindle_6000_to_12000();
    limits.free_turn = deg_to_rad(45);
    limits.feed_per_tooth = 0.1e-3;
    limits.min_feed_per_tooth = 0.05e-3;
    diagram = diagram_of(std::vector<double>(61, 0.9), limits.spindle);
    set_limits(10e-3, 0.9e-3);
    diagram.modes[0].frequency_hz = 738.0;
    diagram.mode_count = 1;
    diagram.direction_speed = rpm_to_rad_s(9000);
    diagram.direction_count = 12;
    for (std::size_t i = 0; i < 12; ++i)
      diagram.directions[i] = {deg_to_rad(15.0 * static_cast<double>(i)), i == 0 ? 0.9e-3 : 2e-3};
    cut.chatter_frequency_hz = 738.0;
    cut.teeth = 2;
    cut.present.speed = cut.programmed.speed = cut.set_speed = rpm_to_rad_s(9000);
    cut.prediction = {&diagram, nullptr, 1e-3};
  }

  void set_limits(double pocket, double elsewhere) {
    for (std::size_t i = 0; i <= 60; ++i) diagram.points[i].depth_limit = i >= 40 && i <= 50 ? pocket : elsewhere;
  }

  // What is asked for, one after the other, if nothing helps.
  std::vector<CorrectionKind> all_asked() {
    std::vector<CorrectionKind> kinds;
    for (int i = 0; i < 20; ++i) {
      const Candidate next = next_candidate(cut, attempts, limits);
      kinds.push_back(next.kind);
      if (next.kind == CorrectionKind::release || next.kind == CorrectionKind::stop_request) break;
      attempts.add(next, cut.prediction.axial_depth);
    }
    return kinds;
  }

  CompensationLimits limits;
  LobeDiagram diagram;
  ChatterSituation cut;
  Attempts attempts;
};

TEST_F(Ladder, ChatterOfTheToolIsMetBySpeedThenVariationThenDirectionThenLessFeedThenAStop) {
  using enum CorrectionKind;
  std::vector<CorrectionKind> asked = all_asked();
  const auto first_other = std::find_if(asked.begin(), asked.end(), [](auto kind) { return kind != spindle_speed; });
  EXPECT_GE(first_other - asked.begin(), 1);
  EXPECT_LE(first_other - asked.begin(), 3);  // no more than three speeds
  asked.erase(asked.begin(), first_other);
  EXPECT_EQ(asked, (std::vector{speed_variation, feed_direction, feed_override, stop_request}));
}

TEST_F(Ladder, ChatterOfTheStructureIsMetByDirectionThenByThePredictedSpeedAndNotByAVariation) {
  using enum CorrectionKind;
  cut.structural = true;
  std::vector<CorrectionKind> asked = all_asked();
  ASSERT_GE(asked.size(), 4U);
  EXPECT_EQ(asked[0], feed_direction);
  EXPECT_EQ(asked[1], spindle_speed);
  asked.erase(asked.begin());
  std::erase(asked, spindle_speed);
  EXPECT_EQ(asked, (std::vector{feed_override, stop_request}));

  attempts = {};
  attempts.refuse(feed_direction);
  EXPECT_EQ(next_candidate(cut, attempts, limits).lobe, 0);  // the tool's recipe does not apply
}

TEST_F(Ladder, AStableSettingOfALowerRungGoesBeforeOneThatIsOnlyBetter) {
  using enum CorrectionKind;
  set_limits(1.01e-3, 0.5e-3);
  diagram.depth_scatter = 0.05;  // with it the pocket is unstable: for a constant speed and for a swing
  EXPECT_EQ(next_candidate(cut, attempts, limits).kind, feed_direction);
  attempts.refuse(feed_direction);
  const Candidate better = next_candidate(cut, attempts, limits);
  EXPECT_EQ(better.kind, spindle_speed);
  EXPECT_EQ(better.confidence_percent, 30);
}

TEST_F(Ladder, NoSpeedIsAskedForTwiceAndShallowerAllMayBeTriedAgain) {
  std::vector<double> speeds;
  Candidate next = next_candidate(cut, attempts, limits);
  for (; next.kind == CorrectionKind::spindle_speed; next = next_candidate(cut, attempts, limits)) {
    for (const double speed : speeds) EXPECT_GT(std::abs(next.setting.speed - speed), 0.01 * speed);
    speeds.push_back(next.setting.speed);
    attempts.add(next, 1e-3);
    ASSERT_LE(speeds.size(), 3U);
  }
  ASSERT_FALSE(speeds.empty());
  cut.prediction.axial_depth = 0.95e-3;  // hardly shallower
  EXPECT_NE(next_candidate(cut, attempts, limits).kind, CorrectionKind::spindle_speed);
  cut.prediction.axial_depth = 1.2e-3;
  EXPECT_NE(next_candidate(cut, attempts, limits).kind, CorrectionKind::spindle_speed);
  set_limits(10e-3, 0.5e-3);  // unstable at 0.8 mm as well
  cut.prediction.axial_depth = 0.8e-3;
  const Candidate shallower = next_candidate(cut, attempts, limits);
  EXPECT_EQ(shallower.kind, CorrectionKind::spindle_speed);
  EXPECT_EQ(shallower.setting.speed, speeds.front());
}

TEST_F(Ladder, WithoutAKnownDepthWhatDidNotHelpIsNotTriedAgain) {
  cut.prediction = {};
  cut.prediction.axial_depth = kNaN;
  std::vector<CorrectionKind> asked = all_asked();
  EXPECT_EQ(asked.back(), CorrectionKind::stop_request);
  EXPECT_EQ(attempts.count(CorrectionKind::speed_variation, kNaN), 1);
  const auto count = static_cast<std::size_t>(attempts.count(CorrectionKind::spindle_speed, kNaN));
  EXPECT_EQ(attempts.speeds(kNaN).count, count);
  EXPECT_EQ(count, 2U);  // 7380 and 11070 rpm
}

TEST_F(Ladder, WhatTheControllerRefusedIsNotAskedForAgain) {
  for (unsigned refused = 0; refused < 32; ++refused) {
    attempts = {};
    for (unsigned i = 0; i < 5; ++i)
      if ((refused >> i & 1U) != 0) attempts.refuse(kEveryAsk[i]);
    for (const CorrectionKind kind : all_asked()) EXPECT_FALSE(attempts.refused(kind)) << int(kind);
  }
}

TEST_F(Ladder, TheEndIsAStopOrWhereNoneMayBeAskedForAReleaseThatSaysSo) {
  for (const CorrectionKind kind : kEveryAsk)
    if (kind != CorrectionKind::stop_request) attempts.refuse(kind);
  const Candidate stop = next_candidate(cut, attempts, limits);
  EXPECT_EQ(stop.kind, CorrectionKind::stop_request);
  EXPECT_EQ(stop.setting.feed_factor, 0.0);
  EXPECT_EQ(stop.setting.speed, cut.present.speed);
  EXPECT_EQ(stop.limited_by & kNoStableSettingKnown, kNoStableSettingKnown);
  limits.may_stop = false;
  const Candidate none = next_candidate(cut, attempts, limits);
  EXPECT_EQ(none.kind, CorrectionKind::release);
  EXPECT_EQ(none.limited_by & kNoStableSettingKnown, kNoStableSettingKnown);
  EXPECT_EQ(none.confidence_percent, 0);
}

TEST_F(Ladder, AfterSixteenAttemptsOnlyTheStopIsLeft) {
  Candidate tried;
  tried.kind = CorrectionKind::spindle_speed;
  for (int i = 0; i < 40; ++i) {
    tried.setting.speed = 500.0 + i / 2;  // each twice: the same once more is no new attempt
    attempts.add(tried, 1e-3);
  }
  EXPECT_EQ(attempts.speeds(1e-3).count, Attempts::kMost);
  cut.prediction.axial_depth = 0.1e-3;
  EXPECT_EQ(next_candidate(cut, attempts, limits).kind, CorrectionKind::stop_request);
}

TEST_F(Ladder, WhatWorkedHereBeforeComesFirstUnlessItWasTriedOrIsPredictedWorse) {
  Remembered worked;
  worked.setting.speed = rpm_to_rad_s(10800);
  cut.remembered = &worked;
  const Candidate again = next_candidate(cut, attempts, limits);
  EXPECT_TRUE(again.remembered);
  EXPECT_EQ(again.setting.speed, worked.setting.speed);
  EXPECT_EQ(again.confidence_percent, 90);

  Attempts failed;
  failed.add(again, 1e-3);
  EXPECT_FALSE(next_candidate(cut, failed, limits).remembered);
  Attempts refused;
  refused.refuse(CorrectionKind::spindle_speed);
  EXPECT_FALSE(next_candidate(cut, refused, limits).remembered);
  worked.setting.speed = rpm_to_rad_s(7000);  // no better than here
  EXPECT_FALSE(next_candidate(cut, attempts, limits).remembered);
  worked.setting.speed = rpm_to_rad_s(12100);
  EXPECT_FALSE(next_candidate(cut, attempts, limits).remembered);
  worked.setting.speed = rpm_to_rad_s(9010);  // it is there
  EXPECT_FALSE(next_candidate(cut, attempts, limits).remembered);
}

TEST_F(Ladder, LessFeedKeepsToTheToolAndToTheOverride) {
  for (const CorrectionKind kind :
       {CorrectionKind::spindle_speed, CorrectionKind::speed_variation, CorrectionKind::feed_direction})
    attempts.refuse(kind);
  limits.min_feed_override = 0.2;
  const Candidate by_tool = next_candidate(cut, attempts, limits);
  EXPECT_EQ(by_tool.kind, CorrectionKind::feed_override);
  EXPECT_NEAR(by_tool.setting.feed_factor, 0.5, 1e-12);
  limits.min_feed_override = 0.7;
  EXPECT_NEAR(next_candidate(cut, attempts, limits).setting.feed_factor, 0.7, 1e-12);
  cut.present.speed = rpm_to_rad_s(10000);  // the override is then above 1 already
  EXPECT_NEAR(next_candidate(cut, attempts, limits).setting.feed_factor, 0.63, 1e-12);
  cut.present.feed_factor = 0.65;  // hardly more than the least
  EXPECT_EQ(next_candidate(cut, attempts, limits).kind, CorrectionKind::stop_request);
}

// No controller keeps the feed turned for them.
TEST_F(Ladder, LessFeedAndAStopTurnTheFeedBack) {
  cut.present.feed_direction = 0.5;
  using enum CorrectionKind;
  for (const CorrectionKind kind : {spindle_speed, speed_variation, feed_direction}) attempts.refuse(kind);
  const Candidate less = next_candidate(cut, attempts, limits);
  EXPECT_EQ(less.kind, feed_override);
  EXPECT_EQ(less.setting.feed_direction, cut.programmed.feed_direction);
  attempts.refuse(feed_override);
  const Candidate stop = next_candidate(cut, attempts, limits);
  EXPECT_EQ(stop.kind, stop_request);
  EXPECT_EQ(stop.setting.feed_direction, cut.programmed.feed_direction);
}

// Margin of a setting by the words of each choice's header, the swing's own mean apart (variation_choice_test.cpp).
double predicted_of(const ChatterSituation& s, const Candidate& c) {
  if (c.kind == CorrectionKind::feed_direction)
    return depth_limit_towards(*s.prediction.here, c.setting.feed_direction) / s.prediction.axial_depth - 1.0;
  return c.kind == CorrectionKind::speed_variation ? c.margin_after : margin_at(s.prediction, c.setting.speed);
}

TEST(RandomLadder, NothingIsPredictedWorseThanThePresentSettingAndAllStaysInsideTheLimits) {
  ChoiceCases cases{20261126};
  int seen[6] = {};
  for (int i = 0; i < 1500; ++i) {
    SpeedCase c = random_speed_case(cases);
    CompensationLimits& limits = c.limits;
    limits.free_turn = cases.chance(0.5) ? cases.between(0.0, 1.5) : 0.0;
    limits.may_stop = cases.chance(0.7);
    if (c.kept.here && cases.chance(0.7)) c.kept.here->direction_speed = c.programmed_speed;
    ChatterSituation s;
    s.structural = cases.chance(0.4);
    s.chatter_frequency_hz = cases.chance(0.1) ? kNaN : c.chatter_frequency_hz;
    s.teeth = c.teeth;
    s.programmed.speed = c.programmed_speed;
    s.programmed.feed_direction = cases.between(-3.0, 3.0);
    s.present = s.programmed;
    s.present.speed = s.set_speed = c.speed;
    s.present.feed_factor = cases.chance(0.7) ? 1.0 : cases.between(0.3, 1.0);
    s.prediction = c.kept.view();
    Remembered worked;
    worked.setting.speed = c.speed * cases.between(0.7, 1.4);
    if (cases.chance(0.3)) s.remembered = &worked;
    Attempts attempts;
    for (int step = 0; step < 10; ++step) {
      const Candidate next = next_candidate(s, attempts, limits);
      ++seen[static_cast<int>(next.kind)];
      if (next.kind == CorrectionKind::release) {
        EXPECT_EQ(next.limited_by & kNoStableSettingKnown, kNoStableSettingKnown);
        EXPECT_FALSE(limits.may_stop);
        break;
      }
      const double now = margin_at(s.prediction, s.present.speed);
      EXPECT_FALSE(predicted_of(s, next) < now) << int(next.kind);
      EXPECT_FALSE(next.margin_after < now) << int(next.kind);
      EXPECT_FALSE(attempts.refused(next.kind));
      EXPECT_GE(next.setting.speed, limits.spindle.min_speed);
      EXPECT_LE(next.setting.speed, limits.spindle.max_speed);
      EXPECT_LE(std::abs(next.setting.feed_direction - s.programmed.feed_direction), limits.free_turn + 1e-9);
      EXPECT_LE(next.setting.variation_ratio, limits.max_variation);
      if (next.kind == CorrectionKind::spindle_speed) {
        EXPECT_TRUE(spindle_may_stay(limits, next.setting.speed));
        if (!next.remembered) {
          EXPECT_TRUE(tooth_may_take(limits, next.setting.speed, c.programmed_speed));
        }
      }
      if (next.kind == CorrectionKind::stop_request) break;
      EXPECT_LT(step, 8) << "there is an end to what can be tried";
      if (cases.chance(0.2)) {
        attempts.refuse(next.kind);
      } else {
        attempts.add(next, s.prediction.axial_depth);
      }
    }
  }
  for (const int count : seen) EXPECT_GT(count, 30);
}

}  // namespace
}  // namespace stillcut
