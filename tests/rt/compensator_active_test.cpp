// Active mode, and what no mode may ever do.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

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
  bench.run(0.1, quiet(0));
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
  bench.run(0.1, quiet(0));
  bench.run_acknowledged(0.1, chattering(0));
  EXPECT_EQ(bench.corrections.back().kind, CorrectionKind::spindle_speed);
}

TEST(Compensator, AnswersToOtherMessagesCountForNothing) {
  Bench bench{RuntimeMode::active};
  bench.in.controller_alive = true;
  bench.run_acknowledged(0.2, chattering(0));
  bench.run_acknowledged(0.1, quiet(0, State::air));
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

TEST(Compensator, ActiveTriesTheNextSpeedThenSaysThatNoneIsKnown) {
  Bench bench{RuntimeMode::active};
  bench.in.controller_alive = true;
  // A machine that follows, and chatters on at every speed: 7380 and 11070 rpm are all there is.
  double speed_rpm = 9000.0;
  std::int64_t second_target_ns = 0;
  for (int i = 0; i < 5000; ++i) {
    bench.step(chattering(0, 738.0, speed_rpm));
    bench.acknowledge(true);
    if (bench.corrections.empty()) continue;
    speed_rpm = bench.corrections.back().spindle_speed_rpm;
    if (second_target_ns == 0 && bench.targets_rpm().size() == 2) second_target_ns = bench.now_ns;
  }
  const std::vector<double> targets = bench.targets_rpm();
  ASSERT_EQ(targets.size(), 2U);
  EXPECT_NEAR(targets[0], 7380.0, 1e-6);
  EXPECT_NEAR(targets[1], 11070.0, 1e-6);
  // The first had time to be reached: 1620 rpm at 3000 rpm/s takes more than half a second.
  EXPECT_GT(second_target_ns - bench.corrections.front().stamp_ns, kSecond / 2);
  ASSERT_EQ(bench.releases(), 1);
  EXPECT_EQ(bench.corrections.back().kind, CorrectionKind::release);
  EXPECT_NE(bench.corrections.back().limited_by & kNoStableSettingKnown, 0);
  EXPECT_EQ(bench.events.size(), 3U);
  EXPECT_TRUE(std::isnan(bench.events.back().spindle_speed_rpm));
}

TEST(Compensator, ActiveGivesUpAfterAFewSpeedsHoweverManyThereAre) {
  Bench bench{RuntimeMode::active};
  bench.in.controller_alive = true;
  double speed_rpm = 9000.0;
  for (int i = 0; i < 20000; ++i) {  // 40 s; 5 kHz gives 13 speeds in the range
    bench.step(chattering(0, 5000.0, speed_rpm));
    bench.acknowledge(true);
    if (!bench.corrections.empty()) speed_rpm = bench.corrections.back().spindle_speed_rpm;
  }
  EXPECT_GE(bench.targets_rpm().size(), 2U);
  EXPECT_LE(bench.targets_rpm().size(), 5U);
  EXPECT_FALSE(bench.compensator().correcting());
  EXPECT_NE(bench.corrections.back().limited_by & kNoStableSettingKnown, 0);
}

TEST(Compensator, WhereEverySpeedIsPredictedWorseNoneIsAsked) {
  Bench bench{RuntimeMode::shadow};
  const LobeDiagram worse = diagram_of({0.1, 0.1, 0.1, 0.9, 0.1, 0.1, 0.1}, spindle_6000_to_12000());
  bench.in.lobes = &worse;
  bench.run(2.0, chattering(0));
  ASSERT_EQ(bench.corrections.size(), 1U);
  EXPECT_EQ(bench.corrections[0].kind, CorrectionKind::release);
  EXPECT_NE(bench.corrections[0].limited_by & kNoStableSettingKnown, 0);
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
    LobeDiagram diagram = diagram_of(limits_mm, spindle);
    std::int64_t sequence = 0;
    for (int i = 0; i < 1500; ++i) {
      if (chance(random) < 0.01) {
        for (double& limit : limits_mm) limit = chance(random) < 0.05 ? kNaN : 2.0 * chance(random);
        diagram = diagram_of(limits_mm, spindle);
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
        ASSERT_EQ(view.doubts, kNoDoubt);
        ASSERT_TRUE(seed % 2 == 0 || bench.in.controller_alive);
        ASSERT_GE(said.spindle_speed_rpm, min_rpm * (1.0 - 1e-12));
        ASSERT_LE(said.spindle_speed_rpm, max_rpm * (1.0 + 1e-12));
        ASSERT_GE(said.spindle_speed_target_rpm, min_rpm * (1.0 - 1e-12));
        ASSERT_LE(said.spindle_speed_target_rpm, max_rpm * (1.0 + 1e-12));
        ASSERT_TRUE(said.feed_override > 0.0 && said.feed_override < 100.0) << said.feed_override;
        ASSERT_FALSE(said.predicted_margin_after <= said.predicted_margin_before);
        if (chosen_now && bench.in.lobes != nullptr) {
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
