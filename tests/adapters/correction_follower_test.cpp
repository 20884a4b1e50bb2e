#include "adapters/correction_follower.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <string>

#include "tests/adapters/correction_messages.hpp"

namespace stillcut {
namespace {

constexpr std::int64_t kCycle_ns = 4'000'000;
constexpr ProgramState kProgram{9000.0, 0.03, 0.0};

FollowerSettings any_controller() {
  FollowerSettings settings;
  settings.min_speed_rpm = 6000.0;
  settings.max_speed_rpm = 12000.0;
  settings.speed_rate_rpm_per_s = 4000.0;
  settings.max_feed_override = 1.2;
  settings.max_path_offset = 1e-3;
  return settings;
}

// A follower at a controller of 4 ms, and the times that go with it.
class Cell {
 public:
  explicit Cell(const FollowerSettings& settings = any_controller()) : follower{settings} { run(1); }

  std::optional<Answer> say(const Correction& correction) { return follower.receive(correction, now_ns); }
  std::string refused(const Correction& correction) {
    const auto answer = say(correction);
    if (!answer) return "not answered";
    return answer->ack.accepted ? "accepted" : answer->reason.data();
  }
  Setpoint run(int cycles, const ProgramState& program = kProgram) {
    for (int i = 0; i < cycles; ++i) setpoint = follower.cycle(now_ns += kCycle_ns, program);
    return setpoint;
  }
  // Says it again before it lapses, as the monitor does.
  Setpoint hold(const Correction& correction, int cycles, const ProgramState& program = kProgram) {
    for (int i = 0; i < cycles; ++i) {
      if (i % 25 == 0) say(next(correction));
      run(1, program);
    }
    return setpoint;
  }
  Correction next(Correction correction) {
    correction.sequence = ++sequence;
    correction.stamp_ns = now_ns + 1'000'000'000'000;  // the monitor's clock is another
    return correction;
  }

  std::int64_t now_ns = 50'000'000'000;
  std::int64_t sequence = 0;
  CorrectionFollower follower;
  Setpoint setpoint;
};

TEST(CorrectionFollower, AsksNothingBesideTheProgramWithoutACorrection) {
  Cell cell;
  for (const double speed : {9000.0, 0.0, 15000.0, 8000.0}) {
    const Setpoint setpoint = cell.run(3, {speed, 0.01, 1.0});
    EXPECT_EQ(setpoint.spindle_speed_rpm, speed);
    EXPECT_EQ(setpoint.spindle_change_rpm, 0.0);
    EXPECT_EQ(setpoint.feed_override, 1.0);
    EXPECT_EQ(setpoint.path_offset, 0.0);
    EXPECT_FALSE(setpoint.stop);
  }
}

TEST(CorrectionFollower, ReachesSpeedAndFeedAndAcknowledges) {
  Cell cell;
  const auto answer = cell.say(cell.next(speed_correction(7380.0, 0.82)));
  ASSERT_TRUE(answer);
  EXPECT_TRUE(answer->ack.accepted);
  EXPECT_EQ(answer->ack.sequence, 1);
  EXPECT_EQ(answer->ack.spindle_speed_rpm, 9000.0);  // what runs now, not what will
  EXPECT_STREQ(answer->reason.data(), "");
  const Setpoint setpoint = cell.hold(speed_correction(7380.0, 0.82), 250);
  EXPECT_DOUBLE_EQ(setpoint.spindle_speed_rpm, 7380.0);
  EXPECT_DOUBLE_EQ(setpoint.spindle_change_rpm, -1620.0);
  EXPECT_DOUBLE_EQ(setpoint.feed_override, 0.82);
  EXPECT_DOUBLE_EQ(cell.say(cell.next(speed_correction(7380.0, 0.82)))->ack.spindle_speed_rpm, 7380.0);
}

TEST(CorrectionFollower, ReturnsToTheProgramExactlyWhenMessagesStop) {
  Cell cell;
  cell.hold(speed_correction(7380.0, 0.82), 250);
  const double left = cell.run(130).spindle_speed_rpm;  // 0.5 s after the last message it lapses
  EXPECT_EQ(cell.follower.counters().lapsed, 1);
  EXPECT_GT(left, 7380.0);
  const Setpoint setpoint = cell.run(1000);
  EXPECT_EQ(setpoint.spindle_change_rpm, 0.0);
  EXPECT_EQ(setpoint.feed_override, 1.0);
}

TEST(CorrectionFollower, ReturnsOnRelease) {
  Cell cell;
  cell.hold(speed_correction(7380.0, 0.82), 250);
  Correction release = cell.next(speed_correction(0.0, 1.0));
  release.kind = CorrectionKind::release;
  EXPECT_EQ(cell.refused(release), "accepted");
  EXPECT_EQ(cell.run(1000).spindle_change_rpm, 0.0);
  EXPECT_EQ(cell.follower.counters().lapsed, 0);
}

TEST(CorrectionFollower, NeverAnswersShadow) {
  Cell cell;
  Correction shadow = cell.next(speed_correction(7380.0, 0.82));
  shadow.mode = RuntimeMode::shadow;
  EXPECT_EQ(cell.refused(shadow), "not answered");
  shadow.mode = RuntimeMode::off;
  EXPECT_EQ(cell.refused(shadow), "not answered");
  EXPECT_EQ(cell.follower.counters().shadow, 2);
  EXPECT_EQ(cell.run(100).spindle_change_rpm, 0.0);
}

TEST(CorrectionFollower, IgnoresRepeatedAndOvertakenMessagesAndCountsGaps) {
  Cell cell;
  const Correction first = cell.next(speed_correction(7380.0, 0.82));
  const Correction second = cell.next(speed_correction(7400.0, 0.82));
  cell.sequence = 9;
  const Correction tenth = cell.next(speed_correction(7500.0, 0.83));
  EXPECT_EQ(cell.refused(second), "accepted");
  EXPECT_EQ(cell.refused(second), "not answered");
  EXPECT_EQ(cell.refused(first), "not answered");
  EXPECT_EQ(cell.refused(tenth), "accepted");
  EXPECT_EQ(cell.follower.counters().old, 2);
  EXPECT_EQ(cell.follower.counters().lost, 7);
  EXPECT_DOUBLE_EQ(cell.run(110).spindle_speed_rpm, 7500.0);
}

TEST(CorrectionFollower, BelievesAMonitorThatWasStartedAgainOnceTheOldCorrectionIsOver) {
  Cell cell;
  cell.sequence = 1000;
  EXPECT_EQ(cell.refused(cell.next(speed_correction(7380.0, 0.82))), "accepted");
  cell.sequence = 0;
  EXPECT_EQ(cell.refused(cell.next(speed_correction(7000.0, 0.8))), "not answered");
  cell.run(130);
  EXPECT_EQ(cell.refused(cell.next(speed_correction(7000.0, 0.8))), "accepted");
}

TEST(CorrectionFollower, RefusesWhatWasLongerOnItsWayThanItIsValid) {
  Cell cell;
  const Correction first = cell.next(speed_correction(7380.0, 0.82));
  const Correction delayed = cell.next(speed_correction(7380.0, 0.82));
  EXPECT_EQ(cell.refused(first), "accepted");
  cell.run(200);
  EXPECT_EQ(cell.refused(delayed), "too late: 799 ms on its way");
  const Setpoint setpoint = cell.run(500);
  EXPECT_EQ(setpoint.spindle_change_rpm, 0.0);
}

TEST(CorrectionFollower, NamesTheLimitThatAMessageBreaks) {
  Cell cell;
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

TEST(CorrectionFollower, RefusesByKindWithTheControllersReason) {
  FollowerSettings settings = any_controller();
  for (int kind = 0; kind < 6; ++kind) {
    settings.refusals = {};
    settings.refusals.at(static_cast<std::size_t>(kind)) = "not with this one";
    Cell cell{settings};
    Correction correction = cell.next(speed_correction(9000.0, 1.0));
    correction.kind = static_cast<CorrectionKind>(kind);
    EXPECT_EQ(cell.refused(correction), "not with this one") << kind;
    EXPECT_FALSE(cell.run(1).stop);
  }
}

TEST(CorrectionFollower, HoldsAFeedThatTheControllerCannotRaiseAndSaysSo) {
  Cell cell;
  const auto answer = cell.say(cell.next(speed_correction(11070.0, 1.23)));
  ASSERT_TRUE(answer && answer->ack.accepted);
  EXPECT_STREQ(answer->reason.data(), "feed override 1.23 is held at 1.20");
  EXPECT_DOUBLE_EQ(cell.hold(speed_correction(11070.0, 1.23), 300).feed_override, 1.2);
}

TEST(CorrectionFollower, LeavesAStandingSpindleAlone) {
  Cell cell;
  cell.run(1, {0.0, 0.0, 0.0});
  EXPECT_EQ(cell.refused(cell.next(speed_correction(7380.0, 0.82))), "the program's spindle stands");
  cell.run(1);
  cell.hold(speed_correction(7380.0, 0.82), 100);
  EXPECT_EQ(cell.run(1, {0.0, 0.03, 0.0}).spindle_speed_rpm, 0.0);
  EXPECT_EQ(cell.run(1).spindle_change_rpm, 0.0);  // and the program's next start is the program's
}

TEST(CorrectionFollower, VariesTheSpeedAroundItsMean) {
  Cell cell;
  Correction vary = speed_correction(9000.0, 1.0);
  vary.kind = CorrectionKind::speed_variation;
  vary.speed_variation_ratio = 0.05;
  vary.speed_variation_hz = 1.0;
  cell.hold(vary, 500);
  double lowest = 1e9, highest = 0.0, sum = 0.0;
  for (int i = 0; i < 250; ++i) {  // one period
    const double speed = cell.hold(vary, 1).spindle_speed_rpm;
    lowest = std::min(lowest, speed);
    highest = std::max(highest, speed);
    sum += speed;
  }
  EXPECT_NEAR(lowest, 8550.0, 1.0);
  EXPECT_NEAR(highest, 9450.0, 1.0);
  EXPECT_NEAR(sum / 250, 9000.0, 1.0);
  EXPECT_EQ(cell.run(2500).spindle_change_rpm, 0.0);
}

TEST(CorrectionFollower, RefusesAVariationThatTheSpindleCannotFollow) {
  Cell cell;
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
  EXPECT_EQ(vary(9000, 0.0, 0.1), "speed_variation_ratio is not above 0 and up to 0.30");
  EXPECT_EQ(vary(9000, 0.01, 11), "speed_variation_hz is not above 0 and up to 10.0");
  EXPECT_EQ(vary(9000, 0.01, std::nan("")), "speed_variation_hz is not above 0 and up to 10.0");
}

TEST(CorrectionFollower, MovesThePathAsideForAFeedDirectionAndBack) {
  Cell cell;
  Correction turn = speed_correction(0.0, 1.0);
  turn.kind = CorrectionKind::feed_direction;
  turn.feed_direction = 0.2;
  EXPECT_EQ(cell.refused(cell.next(turn)), "a turn by 11 deg; the path can be moved aside for 10 deg at most");
  turn.feed_direction = 0.1;
  const Setpoint after = cell.hold(turn, 50);
  EXPECT_NEAR(after.path_offset, 0.03 * std::sin(0.1) * 50 * 0.004, 1e-12);  // feed times the turn's sine
  EXPECT_EQ(after.spindle_change_rpm, 0.0);
  EXPECT_EQ(cell.hold(turn, 500).path_offset, 1e-3);
  EXPECT_EQ(cell.refused(cell.next(turn)), "the path stands at its limit, 1.0 mm aside");
  cell.run(1, {9000.0, 0.03, 1.5});  // a corner of the path
  EXPECT_LT(cell.run(1).path_offset, 1e-3);
  turn.feed_direction = -0.1 + 2.0 * std::numbers::pi;  // the other way, and another way to write it
  EXPECT_EQ(cell.refused(cell.next(turn)), "accepted");
  EXPECT_EQ(cell.run(1000).path_offset, 0.0);
  cell.run(1, {9000.0, 0.0, 0.0});
  EXPECT_EQ(cell.refused(cell.next(turn)), "the tool does not move, its feed direction is not known");
}

TEST(CorrectionFollower, LetsGoWhileItIsHeldBackAndSaysWhy) {
  Cell cell;
  cell.hold(speed_correction(7380.0, 0.82), 250);
  cell.follower.hold_back("the operator has the override");
  EXPECT_EQ(cell.refused(cell.next(speed_correction(7380.0, 0.82))), "the operator has the override");
  EXPECT_EQ(cell.run(1000).spindle_change_rpm, 0.0);
  cell.follower.hold_back(nullptr);
  EXPECT_EQ(cell.refused(cell.next(speed_correction(7380.0, 0.82))), "accepted");
}

TEST(CorrectionFollower, StaysStoppedUntilTheControllerIsStartedAgain) {
  Cell cell;
  cell.hold(speed_correction(7380.0, 0.82), 250);
  Correction stop = cell.next(speed_correction(0.0, 0.0));
  stop.kind = CorrectionKind::stop_request;
  EXPECT_EQ(cell.refused(stop), "accepted");
  EXPECT_TRUE(cell.run(1).stop);
  EXPECT_EQ(cell.run(1000).feed_override, 0.0);
  EXPECT_EQ(cell.refused(cell.next(speed_correction(7380.0, 0.82))),
            "stopped; start the program again at the controller");
  Correction release = cell.next(speed_correction(0.0, 1.0));
  release.kind = CorrectionKind::release;
  EXPECT_EQ(cell.refused(release), "accepted");
  EXPECT_TRUE(cell.run(500).stop);
  cell.follower.started_again();
  EXPECT_FALSE(cell.run(1).stop);
  EXPECT_EQ(cell.run(1000).feed_override, 1.0);
}

// Whatever comes, in whatever order: the setpoint stays in its limits and moves no faster than it may.
TEST(CorrectionFollower, KeepsRatesAndRangesInACampaign) {
  std::mt19937 random{11};
  const auto uniform = [&](double min, double max) { return std::uniform_real_distribution<double>{min, max}(random); };
  const FollowerSettings settings = any_controller();
  Cell cell{settings};
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

TEST(CorrectionFollower, KeepsTheFeedPerToothOnTheWayThereAndBack) {
  for (const double speed : {7380.0, 11070.0}) {
    Cell cell;
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
