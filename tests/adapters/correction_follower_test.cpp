// What is followed, what is answered, and the way back.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/adapters/follower_cell.hpp"

namespace stillcut {
namespace {

TEST(CorrectionFollower, AsksNothingBesideTheProgramWithoutACorrection) {
  FollowerCell cell;
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
  FollowerCell cell;
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
  FollowerCell cell;
  cell.hold(speed_correction(7380.0, 0.82), 250);
  const double left = cell.run(130).spindle_speed_rpm;  // 0.5 s after the last message it lapses
  EXPECT_EQ(cell.follower.counters().lapsed, 1);
  EXPECT_GT(left, 7380.0);
  const Setpoint setpoint = cell.run(1000);
  EXPECT_EQ(setpoint.spindle_change_rpm, 0.0);
  EXPECT_EQ(setpoint.feed_override, 1.0);
}

TEST(CorrectionFollower, ReturnsOnRelease) {
  FollowerCell cell;
  cell.hold(speed_correction(7380.0, 0.82), 250);
  Correction release = cell.next(speed_correction(0.0, 1.0));
  release.kind = CorrectionKind::release;
  EXPECT_EQ(cell.refused(release), "accepted");
  EXPECT_EQ(cell.run(1000).spindle_change_rpm, 0.0);
  EXPECT_EQ(cell.follower.counters().lapsed, 0);
}

TEST(CorrectionFollower, NeverAnswersShadow) {
  FollowerCell cell;
  Correction shadow = cell.next(speed_correction(7380.0, 0.82));
  shadow.mode = RuntimeMode::shadow;
  EXPECT_EQ(cell.refused(shadow), "not answered");
  shadow.mode = RuntimeMode::off;
  EXPECT_EQ(cell.refused(shadow), "not answered");
  EXPECT_EQ(cell.follower.counters().shadow, 2);
  EXPECT_EQ(cell.run(100).spindle_change_rpm, 0.0);
}

TEST(CorrectionFollower, IgnoresRepeatedAndOvertakenMessagesAndCountsGaps) {
  FollowerCell cell;
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
  FollowerCell cell;
  cell.sequence = 1000;
  EXPECT_EQ(cell.refused(cell.next(speed_correction(7380.0, 0.82))), "accepted");
  cell.sequence = 0;
  EXPECT_EQ(cell.refused(cell.next(speed_correction(7000.0, 0.8))), "not answered");
  cell.run(130);
  EXPECT_EQ(cell.refused(cell.next(speed_correction(7000.0, 0.8))), "accepted");

  Correction astray = cell.next(speed_correction(7000.0, 0.8));  // the end of all numbers, and of time
  astray.sequence = std::numeric_limits<std::int64_t>::max();
  astray.stamp_ns = std::numeric_limits<std::int64_t>::max();
  EXPECT_NE(cell.refused(astray), "not answered");
  EXPECT_EQ(cell.refused(cell.next(speed_correction(7000.0, 0.8))), "not answered");
  cell.run(2501);  // ten seconds of nothing
  EXPECT_EQ(cell.refused(cell.next(speed_correction(7000.0, 0.8))), "accepted");
}

TEST(CorrectionFollower, VariesTheSpeedAroundItsMean) {
  FollowerCell cell;
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

TEST(CorrectionFollower, MovesThePathAsideForAFeedDirectionAndBack) {
  FollowerCell cell;
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

// As the simulated machine's controller does: a feed or a direction keeps the speed that it carries.
TEST(CorrectionFollower, AFeedOrADirectionKeepsTheSpeedThatIsInForce) {
  for (const CorrectionKind kind : {CorrectionKind::feed_override, CorrectionKind::feed_direction}) {
    FollowerCell cell;
    cell.hold(speed_correction(7380.0, 0.82), 250);
    Correction next = speed_correction(7380.0, 0.6);
    next.kind = kind;
    next.feed_direction = 0.01;
    EXPECT_EQ(cell.refused(cell.next(next)), "accepted");
    const Setpoint setpoint = cell.hold(next, 250);
    EXPECT_EQ(setpoint.spindle_speed_rpm, 7380.0);
    EXPECT_DOUBLE_EQ(setpoint.feed_override, 0.6);
    EXPECT_EQ(setpoint.path_offset > 0.0, kind == CorrectionKind::feed_direction);
    next.spindle_speed_rpm = 5000.0;
    EXPECT_EQ(cell.refused(cell.next(next)), "spindle_speed_rpm is not from 6000 to 12000");
    EXPECT_EQ(cell.run(2000).spindle_change_rpm, 0.0);
    next.spindle_speed_rpm = std::nan("");  // the programmed one
    EXPECT_EQ(cell.hold(next, 250).spindle_change_rpm, 0.0);
  }
}

TEST(CorrectionFollower, LessFeedMayBeginAtAFasterSpindleWhoseFeedIsHeld) {
  FollowerCell cell;
  cell.hold(speed_correction(11070.0, 1.23), 250);
  Correction less = speed_correction(11070.0, 1.23);
  less.kind = CorrectionKind::feed_override;
  const auto answer = cell.say(cell.next(less));
  ASSERT_TRUE(answer && answer->ack.accepted) << answer->reason.data();
  EXPECT_STREQ(answer->reason.data(), "feed override 1.23 is held at 1.20");
  less.feed_override = 0.7;
  const Setpoint setpoint = cell.hold(less, 250);
  EXPECT_DOUBLE_EQ(setpoint.feed_override, 0.7);
  EXPECT_EQ(setpoint.spindle_speed_rpm, 11070.0);
}

// The direction of a controller that moves no spindle (EGM with --answer path) is followed at the program's speed.
TEST(CorrectionFollower, ADirectionWithoutSpeedsSaysWhichSpeedItHolds) {
  FollowerSettings settings = any_controller();
  for (const std::size_t kind : {1U, 2U, 4U}) settings.refusals.at(kind) = "carries no speeds";
  FollowerCell cell{settings};
  Correction turn = speed_correction(9050.0, 0.5);
  turn.kind = CorrectionKind::feed_direction;
  turn.feed_direction = 0.02;
  const auto answer = cell.say(cell.next(turn));
  ASSERT_TRUE(answer && answer->ack.accepted);
  EXPECT_STREQ(answer->reason.data(), "");
  const Setpoint setpoint = cell.hold(turn, 50);
  EXPECT_EQ(setpoint.spindle_change_rpm, 0.0);
  EXPECT_EQ(setpoint.feed_override, 1.0);
  EXPECT_GT(setpoint.path_offset, 0.0);
  turn.spindle_speed_rpm = 7380.0;
  EXPECT_STREQ(cell.say(cell.next(turn))->reason.data(), "spindle speed 7380 is held at the program's 9000");
}

TEST(CorrectionFollower, LetsGoWhileItIsHeldBackAndSaysWhy) {
  FollowerCell cell;
  cell.hold(speed_correction(7380.0, 0.82), 250);
  cell.follower.hold_back("the operator has the override");
  EXPECT_EQ(cell.refused(cell.next(speed_correction(7380.0, 0.82))), "the operator has the override");
  EXPECT_EQ(cell.run(1000).spindle_change_rpm, 0.0);
  cell.follower.hold_back(nullptr);
  EXPECT_EQ(cell.refused(cell.next(speed_correction(7380.0, 0.82))), "accepted");
}

TEST(CorrectionFollower, StaysStoppedUntilTheControllerIsStartedAgain) {
  FollowerCell cell;
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
}  // namespace
}  // namespace stillcut
