// The multibody paper's passes: what its figures show, in short passes; docs/robot-passes.md has the whole ones.
#include "models/huynh_pass.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include "models/huynh_depth.hpp"
#include "tests/sanitized.hpp"

namespace stillcut {
namespace {

HuynhPass short_pass(PassWay way, Milling milling) {
  HuynhPass pass;
  pass.way = way;
  pass.milling = milling;
  pass.discs = test::kSanitized ? 2 : 4;
  pass.air_time = 0.0;
  pass.cutting_time = 0.25;
  pass.measured_turns = 20;
  pass.wall_length = 2e-3;
  return pass;
}

// Mean force of a turn on straight teeth (Altintas, Manufacturing Automation, ch. 2): the helix does not change it.
Eigen::Vector2d mean_force_of(const Cut& cut) {
  const Material m = huynh_material();
  const auto [entry, exit] = immersion(cut.milling, cut.radial_depth, huynh_tool().diameter);
  const double cos2 = std::cos(2 * exit) - std::cos(2 * entry), sin2 = std::sin(2 * exit) - std::sin(2 * entry);
  const double twice = 2 * (exit - entry), scale = 2 * cut.axial_depth * cut.feed_per_tooth / (8 * std::numbers::pi);
  return scale * Eigen::Vector2d(m.ktc * cos2 - m.krc * (twice - sin2), m.ktc * (twice - sin2) + m.krc * cos2);
}

TEST(HuynhPass, ForcesAreThoseOfThePaperInAllFour) {
  for (const PassWay way : {PassWay::longitudinal, PassWay::transversal})
    for (const Milling milling : {Milling::down, Milling::up}) {
      const HuynhPassResult result = run_huynh_pass(short_pass(way, milling));
      const auto name = std::to_string(static_cast<int>(way)) + std::to_string(static_cast<int>(milling));
      EXPECT_NEAR(result.step, 3.2086e-5, 1e-9);
      const Eigen::Vector2d mean = mean_force_of(huynh_cut(way, milling));
      EXPECT_LT((Eigen::Vector2d(result.feed_mean, result.cross_mean) - mean).norm(), 0.04 * mean.norm()) << name;
      EXPECT_GT(result.cross_peak, 1.02 * result.feed_peak) << name;
      if (milling == Milling::down) {
        EXPECT_GT(result.cross_rms, 2 * result.feed_rms) << name;
      }
      EXPECT_NEAR(result.tooth_peak[1] / result.tooth_peak[0], 190.0 / 170.0, 0.06) << name;  // tooth 1 waits 190 deg
      const Spectrum& lines = result.cross_spectrum;
      for (const double hz : {18700.0 / 60.0, 18700.0 / 30.0}) {
        const auto at = static_cast<std::size_t>(std::lround(hz / lines.resolution));
        EXPECT_NEAR(static_cast<double>(at) * lines.resolution, hz, 1e-6) << name;
        EXPECT_GT(lines.amplitude[at], 1.0) << name;
        EXPECT_GT(lines.amplitude[at], 20 * std::max(lines.amplitude[at - 1], lines.amplitude[at + 1])) << name;
      }
      const double away = milling == Milling::down ? -1.0 : 1.0;  // down-milling pushes off the wall
      EXPECT_GT(away * result.deviation_mean, 2e-6) << name;
      EXPECT_LT(away * result.deviation_mean, 20e-6) << name;
      if (test::kSanitized) return;
    }
}

// With one chord a step the wall shows the chords, whose sagitta is 2.5 um; with sixteen what feed and robot leave. The
// pass is too short for the robot's slow modes to die away: a length of wall that they do not matter in.
TEST(HuynhPass, AHundredStepsATurnAreSeenInTheWall) {
  if (test::kSanitized) return;
  HuynhPass pass = short_pass(PassWay::longitudinal, Milling::down);
  pass.wall_length = 0.8e-3;
  pass.cutting_time = 0.4;
  const ProfileRoughness coarse = over_slices(run_huynh_pass(pass).wall).mean;
  EXPECT_NEAR(coarse.rt, 1.98e-6, 0.3 * 1.98e-6);
  EXPECT_GT(coarse.ra, 0.2e-6);
  EXPECT_LT(coarse.ra, 0.6e-6);
  pass.chords = 16;
  const ProfileRoughness fine = over_slices(run_huynh_pass(pass).wall).mean;
  EXPECT_LT(fine.ra, 0.4 * coarse.ra);
  EXPECT_GT(fine.rt, 0.2e-6);  // cusps of the feed, f^2/8R = 0.22 um
}

TEST(HuynhPass, RefusesWhatIsNoPass) {
  HuynhPass pass = short_pass(PassWay::longitudinal, Milling::slot);
  EXPECT_THROW(run_huynh_pass(pass), std::invalid_argument);
  pass.milling = Milling::down;
  pass.place.x() = 3.0;
  EXPECT_THROW(run_huynh_pass(pass), std::exception);
  pass.place.x() = 1.1;
  pass.cutting_time = 0.0;
  EXPECT_THROW(run_huynh_pass(pass), std::invalid_argument);
}

TEST(AmplitudeSpectrum, FindsTheSinesOfASum) {
  std::vector<double> samples;
  for (int i = 0; i < 1000; ++i)
    samples.push_back(3.0 + 2.0 * std::sin(kTwoPi * 50 * i * 1e-3) + 0.5 * std::cos(kTwoPi * 125 * i * 1e-3 + 0.3));
  const Spectrum spectrum = amplitude_spectrum(samples, 1e-3, 400.0);
  EXPECT_NEAR(spectrum.resolution, 1.0, 1e-12);
  for (std::size_t i = 0; i < spectrum.amplitude.size(); ++i)
    EXPECT_NEAR(spectrum.amplitude[i], i == 0 ? 3.0 : i == 50 ? 2.0 : i == 125 ? 0.5 : 0.0, 1e-6) << i;
}

TEST(HuynhDepth, FindsTheSlowestOfSeveralVibrations) {
  std::vector<Eigen::Vector2d> places;
  for (int i = 0; i < 120; ++i)
    places.push_back(Eigen::Vector2d(1e-5, 2e-5) +
                     std::pow(0.99, 2 * i) * std::cos(0.7 * i) * Eigen::Vector2d(1e-7, 3e-7) +
                     std::pow(0.97, 2 * i) * std::cos(0.9 * i + 1.0) * Eigen::Vector2d(4e-7, -1e-7));
  const TurnMultiplier found = turn_multiplier(places, 2.0, 0.01);
  EXPECT_NEAR(found.modulus, 0.99, 1e-4);
  EXPECT_NEAR(found.frequency, 0.7 / 0.02, 0.01);
  places.resize(30);
  EXPECT_THROW(turn_multiplier(places, 2.0, 0.01), std::invalid_argument);
}

TEST(HuynhDepth, TheWholeRobotInTimeTurnsUnstableWhereTheLobesSay) {
  HuynhPass pass;
  pass.way = PassWay::transversal;
  const DepthLimit limit = huynh_depth_by_lobes(pass, 40e-3);
  EXPECT_NEAR(limit.chatter_frequency / kTwoPi, 17.1, 0.3);  // its first mode, across the arm
  if (test::kSanitized) return;
  const TurnMultiplier below = huynh_multiplier_in_time(pass, 0.98 * limit.depth, 0.5);
  const TurnMultiplier above = huynh_multiplier_in_time(pass, 1.02 * limit.depth, 0.5);
  EXPECT_LT(below.modulus, 1.0);
  EXPECT_GT(above.modulus, 1.0);
  EXPECT_NEAR(above.frequency, limit.chatter_frequency, 0.01 * limit.chatter_frequency);
}

// Shallow, the part and the given immersion tell the same; deep, the part turns unstable earlier
// (docs/robot-passes.md).
TEST(HuynhDepth, AShallowCutDiesDownAlikeInThePart) {
  if (test::kSanitized) return;
  HuynhPass pass;
  pass.way = PassWay::transversal;
  const TurnMultiplier given = huynh_multiplier_in_time(pass, 2e-3, 0.4),
                       part = huynh_multiplier_in_part(pass, 2e-3, 0.4);
  EXPECT_NEAR(part.modulus, given.modulus, 2e-4);
  EXPECT_NEAR(part.frequency, given.frequency, 0.01 * given.frequency);
  EXPECT_LT(part.modulus, 0.998);
}

}  // namespace
}  // namespace stillcut
