// The simulated controller follows each kind of correction at its own rate, or says that it cannot.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/tools/controller_bench.hpp"

namespace stillcut {
namespace {

TEST(VirtualController, VariesTheSpeedAboutItsMeanAsTheSpindleCanFollow) {
  ControllerBench bench;
  double lowest = 1e9, highest = 0.0;
  for (std::int64_t n = 1; bench.time < 4.0; ++n) {  // the same variation asked for again goes on, it does not restart
    bench.controller.receive(vary(9000, n, 0.02, 0.5), bench.time);
    bench.run_until(bench.time + 0.13, [&](double time) {
      if (time < 2.0) return;
      lowest = std::min(lowest, bench.rpm());
      highest = std::max(highest, bench.rpm());
    });
  }
  const double followed = 1.0 / std::hypot(1.0, kTwoPi * 0.5 * 0.3);  // a first-order lag of 0.3 s at 0.5 Hz
  EXPECT_NEAR(highest, 9000 * (1.0 + 0.02 * followed), 5.0);
  EXPECT_NEAR(lowest, 9000 * (1.0 - 0.02 * followed), 5.0);
  EXPECT_EQ(bench.controller.refused(), 0);
}

TEST(VirtualController, VariesNoFurtherThanTheSpindleGoes) {
  ControllerBench bench;
  bench.program.spindle_speed_rpm = 6100;
  double lowest = 1e9;
  for (std::int64_t n = 1; bench.time < 8.0; ++n) {
    bench.controller.receive(vary(6100, n, 0.4, 0.2), bench.time);
    bench.run_until(bench.time + 0.1, [&](double) { lowest = std::min(lowest, bench.rpm()); });
  }
  EXPECT_GE(lowest, 6000.0 - 1e-6);
  EXPECT_LT(lowest, 6010.0);
}

TEST(VirtualController, TurnsTheFeedAtItsRateAndBackWhenReleased) {
  ControllerBench bench;
  bench.program.feed_direction = deg_to_rad(10);
  for (std::int64_t n = 1; bench.time < 1.0; ++n) {
    bench.controller.receive(turn_to(deg_to_rad(40), n), bench.time);
    bench.run_until(bench.time + 0.1, [&](double time) {
      EXPECT_TRUE(bench.controller.feed_moves() || time < 0.03 || time > 0.45);
      EXPECT_LE(rad_to_deg(bench.controller.feed_turn()), std::max(0.0, 60.0 * (time - 0.015)) + 1e-6);
    });
  }
  EXPECT_NEAR(rad_to_deg(bench.controller.feed_turn()), 30.0, 1e-6);
  EXPECT_FALSE(bench.controller.feed_moves());
  EXPECT_NEAR(rad_to_deg(bench.states.back().feed_direction), 40.0, 1e-6);  // the robot tells where it goes
  bench.controller.receive(of_kind(CorrectionKind::release, 100), bench.time);
  bench.run_until(1.0 + 0.025 + 0.25);
  EXPECT_GT(rad_to_deg(bench.controller.feed_turn()), 10.0);
  bench.run_until(1.0 + 0.025 + 0.55);
  EXPECT_NEAR(bench.controller.feed_turn(), 0.0, 1e-9);
  EXPECT_DOUBLE_EQ(bench.rpm(), kProgrammedRpm);
}

TEST(VirtualController, TurnsTheShortWay) {
  ControllerBench bench;
  bench.program.feed_direction = deg_to_rad(170);
  bench.controller.receive(turn_to(deg_to_rad(-170), 1), 0.0);
  bench.run_until(0.45);
  EXPECT_NEAR(rad_to_deg(bench.controller.feed_turn()), 20.0, 1e-6);
}

TEST(VirtualController, FollowsAFeedOverrideWithoutAJump) {
  ControllerBench bench;
  double before = 1.0, fastest = 0.0;
  for (std::int64_t n = 1; bench.time < 0.9; ++n) {
    bench.controller.receive(with_override(of_kind(CorrectionKind::feed_override, n), 0.5), bench.time);
    bench.run_until(bench.time + 0.1, [&](double) {
      fastest = std::max(fastest, std::abs(bench.controller.feed_override() - before) / kControllerStep);
      before = bench.controller.feed_override();
    });
  }
  EXPECT_NEAR(fastest, 1.0 / VirtualController::kFullFeedIn, 1e-6);
  EXPECT_DOUBLE_EQ(bench.controller.feed_override(), 0.5);
  EXPECT_DOUBLE_EQ(bench.states.back().feed_rate, 0.01);
  EXPECT_DOUBLE_EQ(bench.rpm(), kProgrammedRpm);  // no speed named: the programmed one
  bench.run_until(2.0);
  EXPECT_DOUBLE_EQ(bench.controller.feed_override(), 1.0);
}

TEST(VirtualController, StopsForGood) {
  ControllerBench bench;
  bench.run_until(0.1);
  bench.controller.receive(with_override(of_kind(CorrectionKind::stop_request, 1), 0.0), bench.time);
  bench.run_until(0.1 + 0.015 + 0.0082 + VirtualController::kFullFeedIn);
  EXPECT_TRUE(bench.controller.stopped());
  EXPECT_EQ(bench.controller.feed_override(), 0.0);
  ASSERT_EQ(bench.acks.size(), 1U);
  EXPECT_TRUE(bench.acks[0].accepted);
  EXPECT_EQ(bench.acks[0].feed_override, 0.0);
  bench.controller.receive(of_kind(CorrectionKind::release, 2), bench.time);
  bench.run_until(1.0);
  bench.keep_asking(9000, 2.0);  // neither a release nor another correction starts it again, nor the lapse of time
  bench.run_until(4.0);
  EXPECT_EQ(bench.controller.feed_override(), 0.0);
  EXPECT_EQ(bench.states.back().feed_rate, 0.0);
}

TEST(VirtualController, RefusesTheKindsItsScriptLeavesOut) {
  ControllerScript script;
  script.accepts = {CorrectionKind::spindle_speed};
  ControllerBench bench{script};
  using Kind = CorrectionKind;
  const std::vector<Correction> asked{vary(8000, 1, 0.1, 1.0),
                                      turn_to(1.0, 2),
                                      with_override(of_kind(Kind::feed_override, 3), 0.5),
                                      with_override(of_kind(Kind::stop_request, 4), 0.0),
                                      of_kind(Kind::release, 5),
                                      ask_for(9000, 6)};
  for (const Correction& correction : asked) bench.controller.receive(correction, 0.0);
  bench.run_until(0.3);
  ASSERT_EQ(bench.acks.size(), asked.size());
  for (std::size_t i = 0; i < asked.size(); ++i) {
    EXPECT_EQ(bench.acks[i].accepted, i >= 4) << i;
    EXPECT_EQ(bench.reasons[i], i >= 4 ? "" : "cannot do this kind of correction");
  }
  EXPECT_FALSE(bench.controller.stopped());
  EXPECT_EQ(bench.controller.feed_turn(), 0.0);
}

}  // namespace
}  // namespace stillcut
