// The simulated controller and its spindle: what they obey, how fast, and what changes nothing.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/tools/controller_bench.hpp"

namespace stillcut {
namespace {

TEST(VirtualController, SpindleFollowsAsAFirstOrderLag) {
  ControllerBench bench;
  bench.program.spindle_speed_rpm = 8100;  // small: the rate limit, 4000 rpm/s, does not show
  bench.run_until(0.3);
  EXPECT_NEAR(bench.rpm(), 8000 + 100 * (1.0 - std::exp(-1.0)), 0.1);
  bench.run_until(0.6);
  EXPECT_NEAR(bench.rpm(), 8000 + 100 * (1.0 - std::exp(-2.0)), 0.1);
}

TEST(VirtualController, SpindleAcceleratesNoFasterThanItsDrive) {
  ControllerBench bench;
  bench.program.spindle_speed_rpm = 13000;
  double fastest = 0.0, before = bench.rpm();
  bench.run_until(2.0, [&](double) {
    fastest = std::max(fastest, (bench.rpm() - before) / kControllerStep);
    before = bench.rpm();
  });
  EXPECT_NEAR(fastest, 4000.0, 1.0);
  EXPECT_GT(bench.rpm(), 12500);
}

TEST(VirtualController, ObeysAfterItsLagAndAnswers) {
  ControllerBench bench;
  bench.run_until(0.1);
  bench.controller.receive(ask_for(9000, 7), bench.time);
  bench.run_until(0.1 + 0.0149);
  EXPECT_NEAR(bench.rpm(), 8000, 1e-6);
  EXPECT_TRUE(bench.acks.empty());
  bench.run_until(0.1 + 0.015 + 0.0082);  // lag, and at most one cycle
  ASSERT_EQ(bench.acks.size(), 1U);
  EXPECT_TRUE(bench.acks[0].accepted);
  EXPECT_EQ(bench.acks[0].sequence, 7);
  EXPECT_DOUBLE_EQ(bench.acks[0].spindle_speed_rpm, 9000);
  bench.run_until(0.4);
  EXPECT_DOUBLE_EQ(bench.controller.feed_override(), 9000 / kProgrammedRpm);
  EXPECT_GT(bench.rpm(), 8300);
}

TEST(VirtualController, ReturnsToNominalWhenCorrectionsStop) {
  ControllerBench bench;
  bench.keep_asking(9000, 1.5);
  EXPECT_GT(bench.rpm(), 8900);
  bench.run_until(1.41 + 0.5 + 0.01);  // the last message came at 1.4 s and holds for 0.5 s
  EXPECT_FALSE(bench.controller.corrected());
  bench.run_until(4.0);
  EXPECT_DOUBLE_EQ(bench.controller.feed_override(), 1.0);
  EXPECT_NEAR(bench.rpm(), kProgrammedRpm, 2.0);
}

TEST(VirtualController, ReleaseReturnsToNominalAtOnce) {
  ControllerBench bench;
  bench.keep_asking(9000, 0.45);
  bench.controller.receive(ask_for(8000, 100, RuntimeMode::active, CorrectionKind::release), bench.time);
  bench.run_until(0.45 + 0.024);
  EXPECT_FALSE(bench.controller.corrected());
}

TEST(VirtualController, ShadowIsNotFollowedNorAnswered) {
  ControllerBench bench;
  for (int i = 1; i < 10; ++i) {
    bench.controller.receive(ask_for(12000, i, RuntimeMode::shadow), bench.time);
    bench.run_until(0.1 * i);
  }
  EXPECT_DOUBLE_EQ(bench.rpm(), kProgrammedRpm);
  EXPECT_TRUE(bench.acks.empty());
}

struct RefusedCorrection {
  const char* name;
  Correction correction;
  const char* reason;
};

class VirtualControllerRefuses : public testing::TestWithParam<RefusedCorrection> {};

TEST_P(VirtualControllerRefuses, AndChangesNothing) {
  ControllerBench bench;
  bench.controller.receive(GetParam().correction, 0.0);
  bench.run_until(0.3);
  ASSERT_EQ(bench.acks.size(), 1U);
  EXPECT_FALSE(bench.acks[0].accepted);
  EXPECT_EQ(bench.reasons[0], GetParam().reason);
  EXPECT_DOUBLE_EQ(bench.rpm(), kProgrammedRpm);
  EXPECT_DOUBLE_EQ(bench.controller.feed_override(), 1.0);
}

INSTANTIATE_TEST_SUITE_P(
    All, VirtualControllerRefuses,
    testing::Values(
        RefusedCorrection{"TooFast", ask_for(14100, 1), "speed is outside the spindle"},
        RefusedCorrection{"TooSlow", ask_for(100, 1), "speed is outside the spindle"},
        RefusedCorrection{"NoNumber", ask_for(std::nan(""), 1), "speed is outside the spindle"},
        RefusedCorrection{"FeedTooHigh", with_override(ask_for(9000, 1), 3.0), "feed override is out of range"},
        RefusedCorrection{"Expired", with_validity(ask_for(9000, 1), 5), "too late"},
        RefusedCorrection{"FeedStands", with_override(ask_for(9000, 1), 0.0), "feed override is out of range"},
        RefusedCorrection{"VariesTooMuch", vary(8000, 1, 0.6, 1.0), "speed variation is out of range"},
        RefusedCorrection{"VariesTooFast", vary(8000, 1, 0.1, 100.0), "speed variation is out of range"},
        RefusedCorrection{"VariesAboutNoSpeed", vary(0, 1, 0.1, 1.0), "speed is outside the spindle"},
        RefusedCorrection{"NoDirection", turn_to(std::nan(""), 1), "feed direction is out of range"}),
    [](const auto& info) { return info.param.name; });

TEST(VirtualController, LocksCorrectionsWhereItIsToRefuse) {
  ControllerScript script;
  script.faults = {{{0.0, 1.0}, ControllerFaultKind::refuses}};
  ControllerBench bench{script};
  bench.keep_asking(9000, 0.9);
  EXPECT_DOUBLE_EQ(bench.rpm(), kProgrammedRpm);
  EXPECT_EQ(bench.controller.refused(), static_cast<int>(bench.acks.size()));
  EXPECT_GT(bench.acks.size(), 5U);
}

TEST(VirtualController, SilentNeitherSpeaksNorHears) {
  ControllerScript script;
  script.faults = {{{0.2, 1.0}, ControllerFaultKind::silent}};
  ControllerBench bench{script};
  bench.run_until(0.2);
  const std::size_t states = bench.states.size();
  EXPECT_NEAR(static_cast<double>(states), 0.2 / 0.008, 1.0);  // one a cycle
  bench.keep_asking(9000, 0.9);
  EXPECT_EQ(bench.states.size(), states);
  EXPECT_TRUE(bench.acks.empty());
  EXPECT_DOUBLE_EQ(bench.rpm(), kProgrammedRpm);
  bench.run_until(1.2);
  EXPECT_GT(bench.states.size(), states);
}

TEST(VirtualController, MuteObeysWithoutAnAnswer) {
  ControllerScript script;
  script.faults = {{{0.0, 1.0}, ControllerFaultKind::mute}};
  ControllerBench bench{script};
  bench.keep_asking(9000, 0.9);
  EXPECT_GT(bench.rpm(), 8500);
  EXPECT_TRUE(bench.acks.empty());
}

TEST(VirtualController, TakesNoCorrectionThatIsOlderThanOneSeen) {
  ControllerBench bench;
  bench.controller.receive(ask_for(9000, 5), 0.0);
  bench.run_until(0.05);
  bench.controller.receive(ask_for(12000, 4), bench.time);
  bench.run_until(0.1);
  ASSERT_EQ(bench.acks.size(), 1U);
  EXPECT_EQ(bench.acks[0].sequence, 5);
  EXPECT_LT(bench.rpm(), 9000);
}

// Its sequence begins at one again, which must not keep the controller from hearing it for the rest of the day.
TEST(VirtualController, HearsAMonitorThatWasStartedAnew) {
  const auto stamped = [](Correction c, std::int64_t stamp_ns) {
    c.stamp_ns = stamp_ns;
    return c;
  };
  ControllerBench bench;
  bench.controller.receive(stamped(ask_for(9000, 40), 2'000), bench.time);
  bench.run_until(0.1);
  bench.controller.receive(stamped(ask_for(9500, 1), 3'000), bench.time);  // the first one's is still in force
  bench.run_until(1.0);
  ASSERT_FALSE(bench.controller.corrected());
  EXPECT_EQ(bench.acks.size(), 1U);
  bench.controller.receive(stamped(ask_for(9600, 39), 1'000), bench.time);  // an old message of the first
  bench.run_until(1.1);
  EXPECT_EQ(bench.acks.size(), 1U);
  bench.controller.receive(stamped(ask_for(9700, 2), 4'000), bench.time);
  bench.run_until(1.2);
  ASSERT_EQ(bench.acks.size(), 2U);
  EXPECT_EQ(bench.acks[1].sequence, 2);
  EXPECT_TRUE(bench.controller.corrected());
}

}  // namespace
}  // namespace stillcut
