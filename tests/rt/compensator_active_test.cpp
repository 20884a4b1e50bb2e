// Active mode, and what no mode may ever do.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "dsp/integrity.hpp"
#include "dsp/numbers.hpp"
#include "models/lobes.hpp"
#include "rt/compensator.hpp"
#include "tests/rt/compensator_bench.hpp"

namespace stillcut {
namespace {

TEST(Compensator, ActiveAsksNothingOfASilentController) {
  Bench bench{RuntimeMode::active};
  bench.run(1.0, chattering(0));
  ASSERT_EQ(bench.corrections.size(), 1U);
  EXPECT_EQ(bench.corrections[0].kind, CorrectionKind::release);
  bench.in.controller_alive = true;
  bench.run_acknowledged(0.3, chattering(0));
  EXPECT_TRUE(bench.compensator().correcting());
  bench.in.controller_alive = false;
  bench.run(0.3, chattering(0));
  EXPECT_FALSE(bench.compensator().correcting());
  EXPECT_EQ(bench.corrections.back().kind, CorrectionKind::release);
}

TEST(Compensator, ActiveGivesUpAfterASecondWithoutAnAnswer) {
  Bench bench{RuntimeMode::active};
  bench.in.controller_alive = true;
  bench.run(3.0, chattering(0));
  EXPECT_FALSE(bench.compensator().correcting());
  EXPECT_EQ(bench.releases(), 1);  // and then nothing more in this episode
  EXPECT_LE(bench.corrections.back().stamp_ns - bench.corrections.front().stamp_ns, kSecond + 4 * kMillisecond);
  EXPECT_EQ(bench.corrections.back().kind, CorrectionKind::release);
  const std::size_t before = bench.corrections.size();
  bench.run(2.1, quiet(0));
  bench.run(0.1, chattering(0));  // a new episode is a new question
  EXPECT_GT(bench.corrections.size(), before);
}

TEST(Compensator, ActiveRefusedStaysQuietUntilTheEpisodeEnds) {
  Bench bench{RuntimeMode::active};
  bench.in.controller_alive = true;
  bench.run_acknowledged(0.1, chattering(0));
  bench.acknowledge(false);
  bench.run(5.0, chattering(0));
  EXPECT_EQ(bench.corrections.back().kind, CorrectionKind::release);
  EXPECT_EQ(bench.releases(), 1);
  bench.run(2.1, quiet(0));
  bench.run_acknowledged(0.1, chattering(0));
  EXPECT_EQ(bench.corrections.back().kind, CorrectionKind::spindle_speed);
}

TEST(Compensator, AnswersToOtherMessagesCountForNothing) {
  Bench bench{RuntimeMode::active};
  bench.in.controller_alive = true;
  bench.run_acknowledged(0.2, chattering(0));
  bench.run_acknowledged(1.1, quiet(0, State::air));
  bench.run_acknowledged(0.1, chattering(0));
  ASSERT_TRUE(bench.compensator().correcting());
  const std::int64_t newest = bench.corrections.back().sequence;
  for (const std::int64_t sequence : {std::int64_t{-1}, std::int64_t{0}, std::int64_t{1}, newest + 1}) {
    bench.compensator().acknowledge({bench.now_ns, sequence, false, 0.0, 1.0});
  }
  bench.run_acknowledged(0.1, chattering(0));
  EXPECT_TRUE(bench.compensator().correcting());
  for (int i = 0; i < 1000; ++i) {  // accepting what was asked before the last release is no answer either
    bench.step(chattering(0));
    bench.compensator().acknowledge({bench.now_ns, 1, true, 0.0, 1.0});
  }
  EXPECT_FALSE(bench.compensator().correcting());
}

// What was asked for, one entry a start: kinds in order.
std::vector<CorrectionKind> asked_for(const Bench& bench) {
  std::vector<CorrectionKind> kinds;
  double target = 0.0;
  for (const Correction& c : bench.corrections) {
    if (!kinds.empty() && kinds.back() == c.kind && target == c.spindle_speed_target_rpm) continue;
    kinds.push_back(c.kind);
    target = c.spindle_speed_target_rpm;
  }
  return kinds;
}

// A machine that follows every correction and chatters on whatever is done.
void run_following(Bench& bench, double seconds, double frequency_hz = 738.0) {
  double speed_rpm = 9000.0;
  for (int i = 0; i < static_cast<int>(seconds / 0.002); ++i) {
    bench.step(chattering(0, frequency_hz, speed_rpm));
    bench.acknowledge(true);
    if (!bench.corrections.empty()) speed_rpm = bench.corrections.back().spindle_speed_rpm;
  }
}

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

TEST(Compensator, WhatTheControllerCannotDoIsSkipped) {
  Bench bench{RuntimeMode::active};
  bench.in.controller_alive = true;
  double speed_rpm = 9000.0;
  for (int i = 0; i < 10000; ++i) {
    bench.step(chattering(0, 738.0, speed_rpm));
    if (bench.corrections.empty()) continue;
    const Correction& c = bench.corrections.back();
    bench.acknowledge(c.kind == CorrectionKind::spindle_speed || c.kind == CorrectionKind::stop_request);
    if (c.kind == CorrectionKind::spindle_speed) speed_rpm = c.spindle_speed_rpm;
  }
  using Kind = CorrectionKind;
  EXPECT_EQ(asked_for(bench), (std::vector<Kind>{Kind::spindle_speed, Kind::spindle_speed, Kind::speed_variation,
                                                 Kind::feed_override, Kind::stop_request}));
  EXPECT_EQ(bench.releases(), 0);
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

// A sensor driven beyond its range by a cut that is predicted to chatter: to the pocket that the lobes know, and where
// it goes on there or none is known, a stop. One that fails in a sound cut, or where nothing is predicted, is no
// reason.
TEST(Compensator, SaturationIsChatterWhereChatterIsPredicted) {
  using Kind = CorrectionKind;
  const auto asked_with = [](double limit_mm, double pocket_mm) {
    Bench bench{RuntimeMode::active};
    bench.in.controller_alive = true;
    std::vector<double> limits_mm(61, limit_mm);
    for (std::size_t i = 20; i < 25; ++i) limits_mm[i] = pocket_mm;
    const LobeDiagram lobes = diagram_of(limits_mm, spindle_6000_to_12000());
    bench.in.lobes = std::isnan(limit_mm) ? nullptr : &lobes;
    MonitorView saturated = quiet(0, State::cannot_tell);
    saturated.doubts = kSaturated;
    bench.run_acknowledged(12.0, saturated);
    return asked_for(bench);
  };
  EXPECT_EQ(asked_with(0.5, 3.0).at(1), Kind::spindle_speed);
  EXPECT_EQ(asked_with(0.5, 3.0).back(), Kind::stop_request);
  EXPECT_EQ(asked_with(0.5, 0.5).back(), Kind::stop_request);
  EXPECT_EQ(asked_with(2.0, 2.0), (std::vector<Kind>{Kind::release}));
  EXPECT_EQ(asked_with(kNaN, kNaN), (std::vector<Kind>{Kind::release}));
}

TEST(Compensator, WhatWorkedAtAPostureIsTheFirstAnswerThereTheNextTime) {
  Bench bench{RuntimeMode::active};
  bench.in.controller_alive = true;
  RobotState robot;
  bench.in.robot = &robot;
  const auto first_target = [&] {  // of a cut in which only 11070 rpm helps
    const std::size_t before = bench.targets_rpm().size();
    double speed_rpm = 9000.0;
    for (int i = 0; i < 3000; ++i) {
      const bool cured = speed_rpm > 10500.0;
      bench.step(cured ? quiet(0, State::cut, speed_rpm) : chattering(0, 738.0, speed_rpm));
      bench.acknowledge(true);
      if (!bench.corrections.empty() && bench.corrections.back().kind == CorrectionKind::spindle_speed)
        speed_rpm = bench.corrections.back().spindle_speed_rpm;
    }
    bench.run_acknowledged(1.5, quiet(0, State::air));
    const std::vector<double> targets = bench.targets_rpm();
    return targets.size() > before ? targets[before] : kNaN;
  };
  EXPECT_NEAR(first_target(), 7380.0, 1e-6);
  EXPECT_NEAR(bench.targets_rpm().back(), 11070.0, 1e-6);
  bench.corrections.clear();
  EXPECT_NEAR(first_target(), 11070.0, 1e-6);
  robot.joint_position[1] = 0.5;  // elsewhere nothing is known
  bench.corrections.clear();
  EXPECT_NEAR(first_target(), 7380.0, 1e-6);
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

// What is left of chatter is tolerated, but not that it grows back.
TEST(Compensator, AResidueThatGrowsBackIsAnsweredAgain) {
  Bench bench{RuntimeMode::active};
  bench.in.controller_alive = true;
  MonitorView view = chattering(0);
  bench.run_acknowledged(0.5, view);
  view.chatter_amplitude = 0.8;  // of 10 m/s^2
  bench.run_acknowledged(5.0, view);
  EXPECT_EQ(bench.targets_rpm().size(), 1U);  // held
  for (int i = 0; i < 400; ++i) {
    view.chatter_amplitude *= 1.01;
    bench.run_acknowledged(0.002, view);
  }
  EXPECT_GE(bench.targets_rpm().size(), 2U);
}

// A faint line that the lobes contradict is no reason to give a pocket up, however long it lasts, nor to stop.
TEST(Compensator, AFaintLineAgainstThePredictionMovesNothingFromItsPocket) {
  Bench bench{RuntimeMode::active};
  bench.in.controller_alive = true;
  std::vector<double> limits_mm(61, 0.5);
  for (std::size_t i = 10; i < 20; ++i) limits_mm[i] = 4.0;
  const LobeDiagram lobes = diagram_of(limits_mm, spindle_6000_to_12000());
  bench.in.lobes = &lobes;
  bench.run_acknowledged(0.5, chattering(0));
  const double target = bench.corrections.back().spindle_speed_target_rpm;
  bench.run_acknowledged(3.0, quiet(0, State::cut, target));
  MonitorView faint = chattering(0, 738.0, target);
  faint.indicator = 1.5;
  bench.run_acknowledged(30.0, faint);
  EXPECT_EQ(bench.corrections.back().kind, CorrectionKind::spindle_speed);
  EXPECT_EQ(bench.corrections.back().spindle_speed_target_rpm, target);
  EXPECT_EQ(bench.releases(), 0);
}

// What was never believed costs no patience: the first answer to chatter is not a stop.
TEST(Compensator, PatienceBeginsWithTheFirstAnswer) {
  Bench bench{RuntimeMode::active};
  bench.in.controller_alive = true;
  LobeDiagram lobes = diagram_of(std::vector<double>(61, 0.5), spindle_6000_to_12000());
  for (std::size_t i = 10; i < 20; ++i) lobes.points[i].depth_limit = 4e-3;
  lobes.mode_count = 1;
  lobes.modes[0] = {738.0, 0.02};
  bench.in.lobes = &lobes;
  MonitorView elsewhere = quiet(0);  // a slow line at no mode
  elsewhere.structural = true;
  elsewhere.structural_frequency_hz = 16.0;
  bench.run_acknowledged(8.0, elsewhere);
  EXPECT_TRUE(bench.corrections.empty());
  MonitorView both = chattering(0);
  both.structural = true;
  both.structural_frequency_hz = 16.0;
  bench.run_acknowledged(0.5, both);
  ASSERT_FALSE(bench.corrections.empty());
  EXPECT_EQ(bench.corrections.back().kind, CorrectionKind::spindle_speed);
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

// Chatter of the structure: no n_k, but the speeds and directions that the lobes call stable.
TEST(Compensator, StructuralChatterIsAnsweredByWhatTheLobesSay) {
  std::vector<double> limits_mm(61, 0.5);
  for (std::size_t i = 40; i < 50; ++i) limits_mm[i] = 4.0;  // from 10000 to 10900 rpm
  LobeDiagram lobes = diagram_of(limits_mm, spindle_6000_to_12000());
  MonitorView structural = chattering(0, kNaN);
  structural.chatter = false;
  structural.structural = true;
  structural.structural_frequency_hz = 16.0;
  Bench speed{RuntimeMode::shadow};
  speed.in.lobes = &lobes;
  speed.run(0.5, structural);
  ASSERT_FALSE(speed.corrections.empty());
  EXPECT_EQ(speed.corrections.back().kind, CorrectionKind::spindle_speed);
  EXPECT_GT(speed.corrections.back().spindle_speed_target_rpm, 10000.0);
  EXPECT_LT(speed.corrections.back().spindle_speed_target_rpm, 10900.0);
  EXPECT_EQ(speed.corrections.back().chatter_frequency_hz, 16.0);

  lobes.direction_count = 2;  // along X it chatters, along Y it does not
  lobes.direction_speed = rpm_to_rad_s(9000);
  lobes.directions[0] = {0.0, 0.5e-3};
  lobes.directions[1] = {0.5 * std::numbers::pi, 4e-3};
  CompensationLimits limits{.spindle = spindle_6000_to_12000(), .spindle_time_constant_s = 0.05};
  limits.free_turn = std::numbers::pi / 2;
  Bench direction{{RuntimeMode::shadow, 2, limits}};
  direction.in.lobes = &lobes;
  direction.run(4.0, structural);
  ASSERT_FALSE(direction.corrections.empty());
  EXPECT_EQ(direction.corrections.back().kind, CorrectionKind::feed_direction);
  EXPECT_NEAR(std::abs(direction.corrections.back().feed_direction), 0.5 * std::numbers::pi, 1e-6);
  for (std::size_t i = 1; i < direction.corrections.size(); ++i) {  // turned at its rate
    const Correction &a = direction.corrections[i - 1], &b = direction.corrections[i];
    EXPECT_LE(std::abs(b.feed_direction - a.feed_direction),
              limits.turn_rate * static_cast<double>(b.stamp_ns - a.stamp_ns) * 1e-9 * (1.0 + 1e-9) + 1e-12);
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

// Whatever comes in - speeds that jump, frequencies that are no numbers, lobes that come and go, doubts that flicker,
// controllers that answer nonsense - nothing unsafe goes out.
TEST(Compensator, NothingUnsafeIsEverPublished) {
  const SpindleLimits spindle = spindle_6000_to_12000();
  const double min_rpm = rad_s_to_rpm(spindle.min_speed), max_rpm = rad_s_to_rpm(spindle.max_speed);
  std::int64_t asked = 0;
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    std::mt19937_64 random{seed};
    std::uniform_real_distribution<double> chance(0.0, 1.0);
    Bench bench{seed % 2 == 0 ? RuntimeMode::shadow : RuntimeMode::active};
    std::vector<double> limits_mm(61);
    MonitorView view = chattering(0);
    LobeDiagram diagram;
    std::int64_t sequence = 0;
    for (int i = 0; i < 1500; ++i) {
      if (chance(random) < 0.01) {
        for (double& limit : limits_mm) limit = chance(random) < 0.05 ? kNaN : 2.0 * chance(random);
        diagram = diagram_of(limits_mm, spindle);
        // Without predicted frequencies the lobes stay where they are, whatever is heard.
        for (LobePoint& point : diagram.points) point.chatter_frequency_hz = kNaN;
        bench.in.lobes = chance(random) < 0.3 ? nullptr : &diagram;
      }
      if (chance(random) < 0.01) {
        const double pick = chance(random);
        view.speed = pick < 0.1 ? kNaN : pick < 0.2 ? 0.0 : pick < 0.3 ? -100.0 : rpm_to_rad_s(20000 * chance(random));
      }
      if (chance(random) < 0.02) view.chatter = chance(random) < 0.7;
      if (chance(random) < 0.02) view.state = static_cast<State>(8 * chance(random));
      if (chance(random) < 0.02) view.kind = static_cast<ChatterKind>(3 * chance(random));
      if (chance(random) < 0.02) view.indicator = chance(random) < 0.1 ? kNaN : 4.0 * chance(random);
      if (chance(random) < 0.02) {
        view.chatter_frequency_hz = chance(random) < 0.1 ? kNaN : std::pow(10.0, 4.0 * chance(random));
      }
      view.doubts = chance(random) < 0.02 ? 1U << static_cast<int>(7 * chance(random)) : 0U;
      bench.in.axial_depth = chance(random) < 0.1 ? kNaN : 1e-3;
      bench.in.nominal_speed = chance(random) < 0.1 ? kNaN : rpm_to_rad_s(15000 * chance(random));
      bench.in.controller_alive = chance(random) < 0.99;

      const std::size_t before = bench.corrections.size();
      const std::size_t events_before = bench.events.size();
      bench.step(view);
      if (chance(random) < 0.5) bench.acknowledge(chance(random) < 0.99);
      // Every new target is announced by an event; only then is it chosen with what is known now.
      bool chosen_now = false;
      for (std::size_t e = events_before; e < bench.events.size(); ++e) {
        chosen_now = chosen_now || !std::isnan(bench.events[e].spindle_speed_rpm);
      }
      for (std::size_t c = before; c < bench.corrections.size(); ++c) {
        const Correction& said = bench.corrections[c];
        ASSERT_EQ(said.sequence, ++sequence);
        ASSERT_GT(said.valid_for_ms, 0);
        if (said.kind == CorrectionKind::release) {
          ASSERT_EQ(said.feed_override, 1.0);
          continue;
        }
        ++asked;
        // A stop once asked for is not taken back because the monitor goes deaf.
        ASSERT_TRUE(view.doubts == kNoDoubt || view.doubts == kSaturated || said.kind == CorrectionKind::stop_request);
        ASSERT_TRUE(seed % 2 == 0 || bench.in.controller_alive);
        ASSERT_GE(said.spindle_speed_rpm, min_rpm * (1.0 - 1e-12));
        ASSERT_LE(said.spindle_speed_rpm, max_rpm * (1.0 + 1e-12));
        ASSERT_GE(said.spindle_speed_target_rpm, min_rpm * (1.0 - 1e-12));
        ASSERT_LE(said.spindle_speed_target_rpm, max_rpm * (1.0 + 1e-12));
        if (said.kind == CorrectionKind::stop_request) {
          ASSERT_TRUE(said.feed_override >= 0.0 && said.feed_override <= 2.0) << said.feed_override;
        } else {
          ASSERT_TRUE(said.feed_override >= 0.5 && said.feed_override <= 2.0) << said.feed_override;
        }
        ASSERT_FALSE(said.predicted_margin_after < said.predicted_margin_before);
        if (chosen_now && said.kind == CorrectionKind::spindle_speed && bench.in.lobes != nullptr) {
          const double target = rpm_to_rad_s(said.spindle_speed_target_rpm);
          ASSERT_FALSE(margin_at(diagram, target, bench.in.axial_depth) <
                       margin_at(diagram, view.speed, bench.in.axial_depth));
        }
      }
    }
  }
  EXPECT_GT(asked, 1000);
}

}  // namespace
}  // namespace stillcut
