// Active mode: what is asked for, one after the other, where nothing helps, and what time each gets.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "dsp/numbers.hpp"
#include "rt/compensator.hpp"
#include "tests/rt/compensator_bench.hpp"

namespace stillcut {
namespace {

TEST(Compensator, ActiveTriesSpeedsThenVariationThenFeedThenAsksForAStop) {
  Bench bench{RuntimeMode::active};
  bench.in.controller_alive = true;
  run_following(bench, 20.0);
  const std::vector<double> targets = bench.targets_rpm();
  ASSERT_EQ(targets.size(), 2U);  // 7380 and 11070 rpm are all there is
  EXPECT_NEAR(targets[0], 7380.0, 1e-6);
  EXPECT_NEAR(targets[1], 11070.0, 1e-6);
  using Kind = CorrectionKind;
  // The variation needs two slow swings to show; then patience is out.
  EXPECT_EQ(asked_for(bench),
            (std::vector<Kind>{Kind::spindle_speed, Kind::spindle_speed, Kind::speed_variation, Kind::stop_request}));
  EXPECT_EQ(bench.events.size(), 4U);
  EXPECT_TRUE(std::isnan(bench.events.back().spindle_speed_rpm));
  const Correction& last = bench.corrections.back();
  EXPECT_NE(last.limited_by & kNoStableSettingKnown, 0);
  EXPECT_EQ(last.feed_override, 0.0);
  EXPECT_STREQ(last.reason.data(), "no stable setting known: stop");
}

TEST(Compensator, EveryCandidateHasTheTimeOfItsMoveAndOfTheSpindleToAct) {
  Bench bench{RuntimeMode::active};
  bench.in.controller_alive = true;
  run_following(bench, 20.0);
  ASSERT_EQ(bench.events.size(), 4U);
  const auto between_s = [&](std::size_t i) {
    return static_cast<double>(bench.events[i + 1].stamp_ns - bench.events[i].stamp_ns) * 1e-9;
  };
  EXPECT_GT(between_s(0), 1620.0 / 3000.0 + 4 * 0.05);  // 9000 to 7380 rpm at 3000 rpm/s, and four time constants
  EXPECT_GT(between_s(1), 3690.0 / 3000.0 + 4 * 0.05);
  EXPECT_GT(between_s(2), 1.0);  // two swings, at most 2 Hz
}

TEST(Compensator, AStopIsAskedForUntilTheToolIsOutOfThePart) {
  Bench bench{RuntimeMode::active};
  bench.in.controller_alive = true;
  run_following(bench, 12.0);
  ASSERT_EQ(bench.corrections.back().kind, CorrectionKind::stop_request);
  bench.run_acknowledged(3.0, quiet(0));  // no vibration where nothing feeds; the program has not gone on
  EXPECT_EQ(bench.corrections.back().kind, CorrectionKind::stop_request);
  bench.run_acknowledged(1.2, quiet(0, State::air));
  EXPECT_EQ(bench.corrections.back().kind, CorrectionKind::release);
  EXPECT_FALSE(bench.compensator().correcting());
}

TEST(Compensator, WithoutLeaveToStopItSaysThatNothingIsKnownAndReleases) {
  CompensationLimits limits{.spindle = spindle_6000_to_12000(), .spindle_time_constant_s = 0.05};
  limits.may_stop = false;
  Bench bench{{RuntimeMode::active, 2, limits}};
  bench.in.controller_alive = true;
  run_following(bench, 20.0);
  EXPECT_EQ(bench.corrections.back().kind, CorrectionKind::release);
  EXPECT_NE(bench.corrections.back().limited_by & kNoStableSettingKnown, 0);
  EXPECT_EQ(bench.releases(), 1);
  EXPECT_FALSE(bench.compensator().correcting());
  ASSERT_FALSE(bench.events.empty());
  EXPECT_STREQ(bench.events.back().note.data(), "no stable setting known");
}

TEST(Compensator, ActiveGivesUpAfterAFewSpeedsHoweverManyThereAre) {
  Bench bench{RuntimeMode::active};
  bench.in.controller_alive = true;
  run_following(bench, 40.0, 5000.0);  // 13 speeds in the range
  EXPECT_GE(bench.targets_rpm().size(), 2U);
  EXPECT_LE(bench.targets_rpm().size(), 3U);
  EXPECT_EQ(bench.corrections.back().kind, CorrectionKind::stop_request);
}

}  // namespace
}  // namespace stillcut
