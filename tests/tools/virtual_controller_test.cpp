// The simulated controller and its spindle: what they obey, how fast, and what changes nothing.
#include "tools/virtual_controller.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace stillcut {
namespace {

constexpr double kControllerStep = 1e-4;  // s
constexpr double kProgrammedRpm = 8000.0;

SpindleLimits controller_limits() {
  return {rpm_to_rad_s(6000), rpm_to_rad_s(14000), rpm_to_rad_s(4000), rpm_to_rad_s(40000)};
}

Correction ask_for(double rpm, std::int64_t sequence, RuntimeMode mode = RuntimeMode::active,
                   CorrectionKind kind = CorrectionKind::spindle_speed) {
  Correction c;
  c.sequence = sequence;
  c.valid_for_ms = 500;
  c.mode = mode;
  c.kind = kind;
  c.spindle_speed_rpm = c.spindle_speed_target_rpm = rpm;
  c.feed_override = rpm / kProgrammedRpm;
  return c;
}

// A controller that is moved on in small steps; keeps what it says.
struct Bench {
  explicit Bench(const ControllerScript& script = {})
      : controller{script, controller_limits(), rpm_to_rad_s(kProgrammedRpm), 0} {
    program.spindle_speed_rpm = kProgrammedRpm;
    program.feed_rate = 0.02;
  }
  void run_until(double end, const std::function<void(double)>& each = {}) {
    for (; time < end; time += kControllerStep) {
      for (const ControllerMessage& said : controller.advance(time, program)) {
        if (const auto* ack = std::get_if<CorrectionAck>(&said.message)) {
          acks.push_back(*ack);
          reasons.emplace_back(said.reason);
        } else {
          states.push_back(std::get<RobotState>(said.message));
        }
      }
      if (each) each(time);
    }
  }
  void keep_asking(double rpm, double end) {  // a message every 0.1 s, as the monitor sends while it holds
    for (std::int64_t n = 1; time < end; ++n) {
      controller.receive(ask_for(rpm, n), time);
      run_until(std::min(end, time + 0.1));
    }
  }
  [[nodiscard]] double rpm() const { return rad_s_to_rpm(controller.spindle_speed()); }

  VirtualController controller;
  RobotState program;
  std::vector<CorrectionAck> acks;
  std::vector<std::string> reasons;
  std::vector<RobotState> states;
  double time = 0.0;
};

TEST(VirtualController, SpindleFollowsAsAFirstOrderLag) {
  Bench bench;
  bench.program.spindle_speed_rpm = 8100;  // small: the rate limit, 4000 rpm/s, does not show
  bench.run_until(0.3);
  EXPECT_NEAR(bench.rpm(), 8000 + 100 * (1.0 - std::exp(-1.0)), 0.1);
  bench.run_until(0.6);
  EXPECT_NEAR(bench.rpm(), 8000 + 100 * (1.0 - std::exp(-2.0)), 0.1);
}

TEST(VirtualController, SpindleAcceleratesNoFasterThanItsDrive) {
  Bench bench;
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
  Bench bench;
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
  Bench bench;
  bench.keep_asking(9000, 1.5);
  EXPECT_GT(bench.rpm(), 8900);
  bench.run_until(1.41 + 0.5 + 0.01);  // the last message came at 1.4 s and holds for 0.5 s
  EXPECT_FALSE(bench.controller.corrected());
  bench.run_until(4.0);
  EXPECT_DOUBLE_EQ(bench.controller.feed_override(), 1.0);
  EXPECT_NEAR(bench.rpm(), kProgrammedRpm, 2.0);
}

TEST(VirtualController, ReleaseReturnsToNominalAtOnce) {
  Bench bench;
  bench.keep_asking(9000, 0.45);
  bench.controller.receive(ask_for(8000, 100, RuntimeMode::active, CorrectionKind::release), bench.time);
  bench.run_until(0.45 + 0.024);
  EXPECT_FALSE(bench.controller.corrected());
}

TEST(VirtualController, ShadowIsNotFollowedNorAnswered) {
  Bench bench;
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
  Bench bench;
  bench.controller.receive(GetParam().correction, 0.0);
  bench.run_until(0.3);
  ASSERT_EQ(bench.acks.size(), 1U);
  EXPECT_FALSE(bench.acks[0].accepted);
  EXPECT_EQ(bench.reasons[0], GetParam().reason);
  EXPECT_DOUBLE_EQ(bench.rpm(), kProgrammedRpm);
  EXPECT_DOUBLE_EQ(bench.controller.feed_override(), 1.0);
}

Correction with_validity(Correction c, int ms) {
  c.valid_for_ms = ms;
  return c;
}
Correction with_override(Correction c, double feed) {
  c.feed_override = feed;
  return c;
}
Correction of_kind(CorrectionKind kind, std::int64_t sequence) {  // at the programmed speed and feed
  Correction c = ask_for(0, sequence, RuntimeMode::active, kind);
  c.feed_override = 1.0;
  return c;
}
Correction vary(double rpm, std::int64_t sequence, double ratio, double hz) {
  Correction c = ask_for(rpm, sequence, RuntimeMode::active, CorrectionKind::speed_variation);
  c.feed_override = 1.0;
  c.speed_variation_ratio = ratio;
  c.speed_variation_hz = hz;
  return c;
}
Correction turn_to(double direction, std::int64_t sequence) {
  Correction c = of_kind(CorrectionKind::feed_direction, sequence);
  c.feed_direction = direction;
  return c;
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
  Bench bench{script};
  bench.keep_asking(9000, 0.9);
  EXPECT_DOUBLE_EQ(bench.rpm(), kProgrammedRpm);
  EXPECT_EQ(bench.controller.refused(), static_cast<int>(bench.acks.size()));
  EXPECT_GT(bench.acks.size(), 5U);
}

TEST(VirtualController, SilentNeitherSpeaksNorHears) {
  ControllerScript script;
  script.faults = {{{0.2, 1.0}, ControllerFaultKind::silent}};
  Bench bench{script};
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
  Bench bench{script};
  bench.keep_asking(9000, 0.9);
  EXPECT_GT(bench.rpm(), 8500);
  EXPECT_TRUE(bench.acks.empty());
}

TEST(VirtualController, TakesNoCorrectionThatIsOlderThanOneSeen) {
  Bench bench;
  bench.controller.receive(ask_for(9000, 5), 0.0);
  bench.run_until(0.05);
  bench.controller.receive(ask_for(12000, 4), bench.time);
  bench.run_until(0.1);
  ASSERT_EQ(bench.acks.size(), 1U);
  EXPECT_EQ(bench.acks[0].sequence, 5);
  EXPECT_LT(bench.rpm(), 9000);
}

TEST(VirtualController, VariesTheSpeedAboutItsMeanAsTheSpindleCanFollow) {
  Bench bench;
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
  Bench bench;
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
  Bench bench;
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
  Bench bench;
  bench.program.feed_direction = deg_to_rad(170);
  bench.controller.receive(turn_to(deg_to_rad(-170), 1), 0.0);
  bench.run_until(0.45);
  EXPECT_NEAR(rad_to_deg(bench.controller.feed_turn()), 20.0, 1e-6);
}

TEST(VirtualController, FollowsAFeedOverrideWithoutAJump) {
  Bench bench;
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
  Bench bench;
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
  Bench bench{script};
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
