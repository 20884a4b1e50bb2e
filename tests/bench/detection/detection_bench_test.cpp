// The benchmark itself: that a seed is a cut, and that its truth can fail.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/bench/detection/milled_cut.hpp"

namespace stillcut::detection {
namespace {

TEST(DetectionBench, ASeedGivesTheSameCutToTheBit) {
  CutPlan plan = draw_cut(SeedList::tuning, 1, CutKind::knocks);
  CutPlan again = draw_cut(SeedList::tuning, 1, CutKind::knocks);
  plan.duration = again.duration = 1.3;
  const MilledCut a = mill(plan), b = mill(again);
  EXPECT_EQ(a.samples, b.samples);
  EXPECT_EQ(a.turns, b.turns);
  EXPECT_NE(draw_cut(SeedList::judging, 1, CutKind::knocks).limit, plan.limit);
}

// Growth between 10 and 50 % in the simulation beside that for which theory chose the depth.
TEST(DetectionBench, ChatterGrowsAsFastAsItWasPlanned) {
  CutPlan plan = draw_cut(SeedList::tuning, 0, CutKind::tool_chatter);
  plan.setup.tool.runout = 0.0;  // theory knows none
  const CutTruth truth = mill(plan).truth;
  ASSERT_TRUE(std::isfinite(truth.visible_s));
  EXPECT_GE(truth.tenth_s, plan.unstable_from);
  EXPECT_NEAR(std::log(5.0) / (truth.visible_s - truth.tenth_s) / plan.growth_per_s, 1.0, 0.3);
}

// The same cut that stays at its sound depth is never called visible.
TEST(DetectionBench, TruthSeesNoChatterInASoundCut) {
  CutPlan plan = draw_cut(SeedList::tuning, 0, CutKind::tool_chatter);
  const double sound = value_at(plan.schedule.axial_depth, plan.unstable_from - 1e-3);
  plan.schedule.axial_depth.back().value = sound;
  plan.reference_scale = 1.0;
  const CutTruth truth = mill(plan).truth;
  EXPECT_TRUE(std::isnan(truth.visible_s));
  EXPECT_GT(truth.forced, 0.0);
}

// A forced vibration of many orders, and a line between them that grows by a known rate.
TEST(DetectionBench, TruthReadsAKnownLine) {
  constexpr double kRate = 20000.0, kGrowth = 12.0, kHz = 742.0, kSpindle_hz = 100.0;
  TipMotion motion;
  motion.rate_hz = kRate;
  for (int i = 0; i < 12000; ++i) {
    const double t = i / kRate, turn = kTwoPi * kSpindle_hz * t;
    const double line = 1e-7 * std::exp(kGrowth * t) * std::cos(kTwoPi * kHz * t);
    motion.angle.push_back(turn);
    motion.x.push_back(1e-5 * std::cos(2.0 * turn) + 4e-6 * std::cos(7.0 * turn + 1.0) + line);
    motion.y.push_back(0.0);
  }
  const TipLine line{kHz, kGrowth, false};
  const std::vector<double> amplitude = line_amplitude(motion, line);
  EXPECT_NEAR(amplitude[500], 1e-7 * std::exp(kGrowth * 0.5), 2e-6 * 0.05);
  EXPECT_NEAR(line_frequency(motion, {kHz - 2.0, kGrowth, false}, 0.4, 0.05), kHz, 0.1);
  const Rise rise = rise_of(amplitude, 1e-6, 5e-6, 0.1);
  EXPECT_NEAR(rise.limit_s, std::log(10.0) / kGrowth, 0.003);
  EXPECT_NEAR(rise.proof_s, std::log(50.0) / kGrowth, 0.003);
  EXPECT_TRUE(std::isnan(rise_of(amplitude, 1e-6, 1.0, 0.1).limit_s));
}

}  // namespace
}  // namespace stillcut::detection
