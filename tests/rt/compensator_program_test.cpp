// Prediction, memory and the program: where to, and back again.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "dsp/integrity.hpp"
#include "dsp/numbers.hpp"
#include "rt/compensator.hpp"
#include "tests/rt/compensator_bench.hpp"

namespace stillcut {
namespace {

TEST(Compensator, WhereEverySpeedIsPredictedWorseNoneIsAsked) {
  Bench bench{RuntimeMode::shadow};
  const LobeDiagram worse = diagram_of({0.1, 0.1, 0.1, 0.9, 0.1, 0.1, 0.1}, spindle_6000_to_12000());
  bench.in.lobes = &worse;
  bench.run(2.0, chattering(0));
  ASSERT_FALSE(bench.corrections.empty());
  for (const Correction& c : bench.corrections) {
    EXPECT_EQ(c.kind, CorrectionKind::feed_override);
    EXPECT_NEAR(c.spindle_speed_rpm, 9000.0, 1e-6);
    EXPECT_NE(c.limited_by & kNoStableSettingKnown, 0);
  }
}

// A structure that is stiff from 30 degrees on, at a robot whose feed may turn by 35.
struct TurningFeed {
  explicit TurningFeed(bool robot_tells_motion) : tells_motion{robot_tells_motion} {
    bench.in.controller_alive = true;
    lobes.direction_count = 12;
    lobes.direction_speed = rpm_to_rad_s(9000);
    for (std::size_t i = 0; i < 12; ++i)
      lobes.directions[i] = {deg_to_rad(15.0 * static_cast<double>(i)), i < 2 || i > 9 ? 0.5e-3 : 4e-3};
    bench.in.lobes = &lobes;
    structural.chatter = false;
    structural.structural = true;
    structural.structural_frequency_hz = 16.0;
  }
  static CompensationLimits limits() {
    CompensationLimits limits{.spindle = spindle_6000_to_12000(), .spindle_time_constant_s = 0.05};
    limits.free_turn = deg_to_rad(35);
    return limits;
  }
  void run(double seconds, std::uint32_t doubts) {
    structural.doubts = doubts;
    for (int i = 0; i < static_cast<int>(seconds / 0.002); ++i) {
      bench.run_acknowledged(0.002, structural);
      const bool turned = !bench.corrections.empty() && bench.corrections.back().kind == CorrectionKind::feed_direction;
      const double left = (turned ? bench.corrections.back().feed_direction : 0.0) - feed;
      feed += std::clamp(left, -0.001, 0.001);  // half a rad a second
      if (tells_motion) bench.in.feed_direction = feed;
    }
  }

  LobeDiagram lobes = diagram_of(std::vector<double>(61, 0.5), spindle_6000_to_12000());
  Bench bench{{RuntimeMode::active, 2, limits()}};
  MonitorView structural = chattering(0, kNaN);
  double feed = 0.0;
  bool tells_motion;
};

// Released by a doubt the feed turns back, at its own pace: until it is there, where it goes is not the program.
TEST(Compensator, AFeedThatTurnsBackIsNotTakenForProgrammed) {
  for (const bool tells_motion : {true, false}) {
    TurningFeed cut{tells_motion};
    cut.run(1.3, kNoDoubt);
    const Correction turned = cut.bench.corrections.back();
    ASSERT_EQ(turned.kind, CorrectionKind::feed_direction);
    ASSERT_NEAR(turned.feed_direction, deg_to_rad(30), 1e-6);
    cut.run(0.1, kGap);
    ASSERT_EQ(cut.bench.releases(), 1);
    cut.bench.corrections.clear();
    cut.run(0.1, kNoDoubt);
    ASSERT_TRUE(cut.bench.compensator().correcting());
    for (const Correction& c : cut.bench.corrections) {  // nothing is asked for that jumps from where the feed is
      EXPECT_FALSE(c.kind == CorrectionKind::feed_direction && c.feed_direction < deg_to_rad(20)) << tells_motion;
    }
    cut.run(0.1, kGap);
    EXPECT_EQ(cut.bench.corrections.back().kind, CorrectionKind::release);
    EXPECT_NEAR(cut.bench.corrections.back().feed_direction, 0.0, 1e-6) << tells_motion;
    cut.run(2.0, kGap);  // back
    cut.bench.corrections.clear();
    cut.run(1.3, kNoDoubt);
    EXPECT_EQ(cut.bench.corrections.front().kind, CorrectionKind::feed_direction);
    EXPECT_NEAR(cut.bench.corrections.back().feed_direction, deg_to_rad(30), 1e-6) << tells_motion;
  }
}

// A pocket here that the announced path leaves is none.
TEST(Compensator, LooksAheadAlongTheAnnouncedPath) {
  std::vector<double> here(61, 0.5), ahead(61, 0.5);
  for (std::size_t i = 12; i < 16; ++i) here[i] = 4.0;             // about 7380 rpm
  for (std::size_t i = 48; i < 56; ++i) here[i] = ahead[i] = 4.0;  // about 11070 rpm
  const LobeDiagram lobes = diagram_of(here, spindle_6000_to_12000());
  const LobeDiagram along = diagram_of(ahead, spindle_6000_to_12000());
  for (const bool announced : {false, true}) {
    Bench bench{RuntimeMode::shadow};
    bench.in.lobes = &lobes;
    bench.in.lobes_ahead = announced ? &along : nullptr;
    bench.run(0.5, chattering(0));
    EXPECT_NEAR(bench.targets_rpm().back(), announced ? 11070.0 : 7380.0, 1.0);
  }
}

// The first speed asked for in a cut of some seconds in which only 11070 rpm helps.
double first_target_where_only_11070_helps(Bench& bench, double seconds = 6.0) {
  bench.corrections.clear();
  double speed_rpm = 9000.0;
  for (int i = 0; i < static_cast<int>(seconds / 0.002); ++i) {
    const bool cured = speed_rpm > 10500.0;
    bench.step(cured ? quiet(0, State::cut, speed_rpm) : chattering(0, 738.0, speed_rpm));
    bench.acknowledge(true);
    if (!bench.corrections.empty() && bench.corrections.back().kind == CorrectionKind::spindle_speed)
      speed_rpm = bench.corrections.back().spindle_speed_rpm;
  }
  bench.run_acknowledged(1.5, quiet(0, State::air));
  const std::vector<double> targets = bench.targets_rpm();
  return targets.empty() ? kNaN : targets.front();
}

TEST(Compensator, WhatWorkedAtAPostureIsTheFirstAnswerThereTheNextTime) {
  Bench bench{RuntimeMode::active};
  bench.in.controller_alive = true;
  RobotState robot;
  bench.in.robot = &robot;
  EXPECT_NEAR(first_target_where_only_11070_helps(bench), 7380.0, 1e-6);
  EXPECT_NEAR(bench.targets_rpm().back(), 11070.0, 1e-6);
  EXPECT_NEAR(first_target_where_only_11070_helps(bench), 11070.0, 1e-6);
  robot.joint_position[1] = 0.5;  // elsewhere nothing is known
  EXPECT_NEAR(first_target_where_only_11070_helps(bench), 7380.0, 1e-6);
}

// Another speed that fails at the same place says nothing against the one that worked there.
TEST(Compensator, OnlyTheRememberedSpeedThatFailedItselfIsForgotten) {
  Bench bench{RuntimeMode::active};
  bench.in.controller_alive = true;
  RobotState robot;
  bench.in.robot = &robot;
  EXPECT_NEAR(first_target_where_only_11070_helps(bench), 7380.0, 1e-6);
  bench.in.axial_depth = 1.5e-3;  // deeper than is remembered: begins with 7380 rpm, and ends before the next
  EXPECT_NEAR(first_target_where_only_11070_helps(bench, 2.5), 7380.0, 1e-6);
  EXPECT_NEAR(bench.targets_rpm().back(), 11070.0, 1e-6);
  bench.in.axial_depth = 1e-3;
  EXPECT_NEAR(first_target_where_only_11070_helps(bench), 11070.0, 1e-6);
  bench.run_acknowledged(0.5, chattering(0));
  const double there = bench.targets_rpm().back();
  EXPECT_NEAR(there, 11070.0, 1e-6);
  bench.run_acknowledged(4.0, chattering(0, 738.0, there));  // now it fails
  bench.run_acknowledged(1.5, quiet(0, State::air));
  EXPECT_NEAR(first_target_where_only_11070_helps(bench), 7380.0, 1e-6);
}

// Stable again at the program since the cut is less deep: back, slowly, and released when there. Where chatter comes
// back on the way, back to what helped, and not a second time in this cut.
TEST(Compensator, ReturnsSlowlyWhenTheReasonIsGoneAndNotASecondTimeInVain) {
  for (const bool comes_back : {false, true}) {
    Bench bench{RuntimeMode::active};
    bench.in.controller_alive = true;
    std::vector<double> limits_mm(61, 1.0);
    for (std::size_t i = 10; i < 20; ++i) limits_mm[i] = 4.0;  // a pocket about 7500 rpm
    const LobeDiagram lobes = diagram_of(limits_mm, spindle_6000_to_12000());
    bench.in.lobes = &lobes;
    bench.in.axial_depth = 1.5e-3;
    bench.run_acknowledged(0.5, chattering(0));
    const double target = bench.corrections.back().spindle_speed_target_rpm;
    EXPECT_NEAR(target, 7380.0, 1.0);
    bench.run_acknowledged(4.0, quiet(0, State::cut, target));
    EXPECT_EQ(bench.corrections.back().spindle_speed_target_rpm, target);  // the reason is still there
    bench.in.axial_depth = 0.5e-3;
    bench.run_acknowledged(0.9, quiet(0, State::cut, target));
    EXPECT_EQ(bench.corrections.back().spindle_speed_target_rpm, target);  // the way out of the part is no reason
    bench.run_acknowledged(1.0, quiet(0, State::cut, target));
    ASSERT_EQ(bench.corrections.back().kind, CorrectionKind::spindle_speed);
    EXPECT_NEAR(bench.corrections.back().spindle_speed_target_rpm, 9000.0, 1e-6);
    EXPECT_LT(bench.corrections.back().spindle_speed_rpm, target + 1.1 * 300.0);  // a tenth of 3000 rpm/s
    if (!comes_back) {
      bench.run_acknowledged(10.0, quiet(0));
      EXPECT_FALSE(bench.compensator().correcting());
      EXPECT_EQ(bench.corrections.back().kind, CorrectionKind::release);
      EXPECT_EQ(bench.releases(), 1);
      continue;
    }
    // Stable by the prediction: it has to last a second before it is answered.
    bench.run_acknowledged(1.3, chattering(0));
    EXPECT_EQ(bench.corrections.back().spindle_speed_target_rpm, target);
    bench.run_acknowledged(20.0, quiet(0, State::cut, target));
    EXPECT_EQ(bench.corrections.back().spindle_speed_target_rpm, target);
    EXPECT_EQ(bench.releases(), 0);
  }
}

TEST(Compensator, AnotherProgrammedSpeedEndsTheCorrection) {
  Bench bench{RuntimeMode::active};
  bench.in.controller_alive = true;
  bench.run_acknowledged(0.5, chattering(0));
  ASSERT_TRUE(bench.compensator().correcting());
  bench.in.nominal_speed = rpm_to_rad_s(6500);
  bench.run_acknowledged(0.1, quiet(0));
  EXPECT_FALSE(bench.compensator().correcting());
  EXPECT_EQ(bench.releases(), 1);
}

}  // namespace
}  // namespace stillcut
