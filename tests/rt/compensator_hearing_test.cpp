// What is believed to be chatter, and for how long: a saturated sensor, a residue, a faint line, a structure's.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "dsp/integrity.hpp"
#include "dsp/numbers.hpp"
#include "rt/compensator.hpp"
#include "tests/rt/compensator_bench.hpp"

namespace stillcut {
namespace {

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

// What is left of chatter is tolerated, but not that it grows back.
// The doubt outlasts the last sample at the end of the range by half a second: what it tells at the end of the move is
// of the way there, and no reason to take the setting for tried.
TEST(Compensator, SaturationOnTheWayToASettingIsNoEvidenceAgainstIt) {
  Bench bench{RuntimeMode::active};
  bench.in.controller_alive = true;
  const std::int64_t asked_ns = bench.now_ns;
  bench.run_acknowledged(0.2, chattering(0));
  const double target = bench.targets_rpm().back();
  MonitorView saturated = quiet(0, State::cannot_tell, target);
  saturated.doubts = kSaturated;
  while (bench.compensator().correcting() && bench.now_ns < asked_ns + 1900 * kMillisecond)  // 1.4 s to move and act
    bench.run_acknowledged(0.002, saturated);
  EXPECT_TRUE(bench.compensator().correcting());
  bench.run_acknowledged(3.0, quiet(0, State::cut, target));
  EXPECT_EQ(bench.releases(), 0);
  bench.run_acknowledged(1.5, quiet(0, State::air));
  bench.run_acknowledged(0.2, chattering(0));
  EXPECT_EQ(bench.targets_rpm().back(), target);
  EXPECT_EQ(bench.targets_rpm().size(), 1U);
}

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

}  // namespace
}  // namespace stillcut
