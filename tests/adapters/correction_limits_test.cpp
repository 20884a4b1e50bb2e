// What is refused and why, and the limits that the setpoint keeps.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/adapters/follower_cell.hpp"

namespace stillcut {
namespace {

TEST(CorrectionLimits, RefusesWhatWasLongerOnItsWayThanItIsValid) {
  FollowerCell cell;
  const Correction first = cell.next(speed_correction(7380.0, 0.82));
  const Correction delayed = cell.next(speed_correction(7380.0, 0.82));
  EXPECT_EQ(cell.refused(first), "accepted");
  cell.run(200);
  EXPECT_EQ(cell.refused(delayed), "too late: 799 ms on its way");
  const Setpoint setpoint = cell.run(500);
  EXPECT_EQ(setpoint.spindle_change_rpm, 0.0);
}

TEST(CorrectionLimits, NamesTheLimitThatAMessageBreaks) {
  FollowerCell cell;
  const double nan = std::nan("");
  const auto with = [&](auto change) {
    Correction correction = cell.next(speed_correction(7380.0, 0.82));
    change(correction);
    return cell.refused(correction);
  };
  EXPECT_EQ(with([](Correction& c) { c.spindle_speed_rpm = 5999.0; }), "spindle_speed_rpm is not from 6000 to 12000");
  EXPECT_EQ(with([](Correction& c) { c.spindle_speed_rpm = 12001.0; }), "spindle_speed_rpm is not from 6000 to 12000");
  EXPECT_EQ(with([&](Correction& c) { c.spindle_speed_rpm = nan; }), "spindle_speed_rpm is not from 6000 to 12000");
  EXPECT_EQ(with([](Correction& c) { c.feed_override = 0.2; }), "feed_override is below 0.30, or no number");
  EXPECT_EQ(with([&](Correction& c) { c.feed_override = nan; }), "feed_override is below 0.30, or no number");
  EXPECT_EQ(with([](Correction& c) { c.valid_for_ms = 0; }), "valid_for_ms is not from 1 to 10000");
  EXPECT_EQ(with([](Correction& c) { c.valid_for_ms = 10001; }), "valid_for_ms is not from 1 to 10000");
  const auto feed = [&](double value) {
    return with([&](Correction& c) { c.kind = CorrectionKind::feed_override, c.feed_override = value; });
  };
  for (const double value : {0.29, 1.21, nan}) EXPECT_EQ(feed(value), "feed_override is not from 0.30 to 1.20");
  EXPECT_EQ(feed(0.3), "accepted");
  EXPECT_EQ(feed(1.2), "accepted");
  EXPECT_EQ(cell.follower.counters().refused, 10);
}

TEST(CorrectionLimits, RefusesByKindWithTheControllersReason) {
  FollowerSettings settings = any_controller();
  for (int kind = 0; kind < 6; ++kind) {
    settings.refusals = {};
    settings.refusals.at(static_cast<std::size_t>(kind)) = "not with this one";
    FollowerCell cell{settings};
    Correction correction = cell.next(speed_correction(9000.0, 1.0));
    correction.kind = static_cast<CorrectionKind>(kind);
    EXPECT_EQ(cell.refused(correction), "not with this one") << kind;
    EXPECT_FALSE(cell.run(1).stop);
  }
}

TEST(CorrectionLimits, HoldsAFeedThatTheControllerCannotRaiseAndSaysSo) {
  FollowerCell cell;
  const auto answer = cell.say(cell.next(speed_correction(11070.0, 1.23)));
  ASSERT_TRUE(answer && answer->ack.accepted);
  EXPECT_STREQ(answer->reason.data(), "feed override 1.23 is held at 1.20");
  EXPECT_DOUBLE_EQ(cell.hold(speed_correction(11070.0, 1.23), 300).feed_override, 1.2);
}

TEST(CorrectionLimits, LeavesAStandingSpindleAlone) {
  FollowerCell cell;
  cell.run(1, {0.0, 0.0, 0.0});
  EXPECT_EQ(cell.refused(cell.next(speed_correction(7380.0, 0.82))), "the program's spindle stands");
  cell.run(1);
  cell.hold(speed_correction(7380.0, 0.82), 100);
  EXPECT_EQ(cell.run(1, {0.0, 0.03, 0.0}).spindle_speed_rpm, 0.0);
  EXPECT_EQ(cell.run(1).spindle_change_rpm, 0.0);  // and the program's next start is the program's
}

TEST(CorrectionLimits, RefusesAVariationThatTheSpindleCannotFollow) {
  FollowerCell cell;
  const auto vary = [&](double speed, double ratio, double hz) {
    Correction c = cell.next(speed_correction(speed, 1.0));
    c.kind = CorrectionKind::speed_variation;
    c.speed_variation_ratio = ratio;
    c.speed_variation_hz = hz;
    return cell.refused(c);
  };
  EXPECT_EQ(vary(9000, 0.1, 1.0), "the variation takes 5655 rpm/s, the spindle has 4000");
  EXPECT_EQ(vary(11900, 0.1, 0.1), "the varied speed leaves 6000 to 12000 rpm");
  EXPECT_EQ(vary(9000, 0.31, 0.1), "speed_variation_ratio is not above 0 and up to 0.30");
  EXPECT_EQ(vary(9000, -0.1, 0.1), "speed_variation_ratio is not above 0 and up to 0.30");
  EXPECT_EQ(vary(9000, 0.0, 0.0), "accepted");  // on the way to its mean
  EXPECT_EQ(vary(9000, 0.01, 11), "speed_variation_hz is not above 0 and up to 10.0");
  EXPECT_EQ(vary(9000, 0.01, std::nan("")), "speed_variation_hz is not above 0 and up to 10.0");
}

TEST(CorrectionLimits, KeepsRatesAndRangesInACampaign) {
  std::mt19937 random{11};
  const auto uniform = [&](double min, double max) { return std::uniform_real_distribution<double>{min, max}(random); };
  const FollowerSettings settings = any_controller();
  FollowerCell cell{settings};
  Setpoint before = cell.run(1);
  for (int i = 0; i < 200'000; ++i) {
    if (uniform(0, 1) < 0.02) {
      Correction c = cell.next(speed_correction(uniform(5000, 13000), uniform(0.2, 1.3)));
      c.kind = static_cast<CorrectionKind>(std::uniform_int_distribution<int>{0, 4}(random));
      c.speed_variation_ratio = uniform(-0.1, 0.35);
      c.speed_variation_hz = uniform(0, 3);
      c.feed_direction = uniform(-0.3, 0.3);
      if (c.kind == CorrectionKind::spindle_speed)
        c.feed_override = c.spindle_speed_rpm / 9000.0;  // feed per tooth kept
      if (c.kind == CorrectionKind::speed_variation) c.feed_override = c.spindle_speed_rpm / 9000.0;
      cell.say(c);
    }
    const Setpoint now = cell.run(1);
    ASSERT_LE(std::abs(now.spindle_speed_rpm - before.spindle_speed_rpm), 4000.0 * 0.004 * 1.0001);
    ASSERT_GE(now.spindle_speed_rpm, settings.min_speed_rpm * 0.999999);
    ASSERT_LE(now.spindle_speed_rpm, settings.max_speed_rpm * 1.000001);
    ASSERT_LE(now.feed_override - before.feed_override, 0.4 * 0.004 * 1.0001);
    ASSERT_GE(now.feed_override, 0.0);
    ASSERT_LE(now.feed_override, 1.2);
    ASSERT_LE(std::abs(now.path_offset), 1e-3);
    ASSERT_LE(std::abs(now.path_offset - before.path_offset), 0.005 * 0.004 * 1.0001);
    before = now;
  }
  EXPECT_GT(cell.follower.counters().accepted, 500);
  EXPECT_GT(cell.follower.counters().refused, 500);
}

TEST(CorrectionLimits, KeepsTheFeedPerToothOnTheWayThereAndBack) {
  for (const double speed : {7380.0, 11070.0}) {
    FollowerCell cell;
    for (int i = 0; i < 3000; ++i) {
      const Setpoint now = i < 500 ? cell.hold(speed_correction(speed, speed / 9000.0), 1) : cell.run(1);
      ASSERT_LE(now.feed_override, now.spindle_speed_rpm / 9000.0 + 1e-9) << i;
    }
    EXPECT_EQ(cell.setpoint.spindle_change_rpm, 0.0);
    EXPECT_EQ(cell.setpoint.feed_override, 1.0);
  }
}

}  // namespace
}  // namespace stillcut
