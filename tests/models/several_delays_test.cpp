// Teeth of unequal pitch. Against time integration they stand in floquet_against_time_test.
#include <gtest/gtest.h>

#include <cmath>

#include "models/floquet.hpp"
#include "stability_cases.hpp"

namespace stillcut {
namespace {

// The same tool described as one of unequal pitch: a turn of the spindle is `teeth` tooth periods.
TEST(SeveralDelays, EqualPitchGivesTheToothPeriodsRadiusToThePowerOfTheTeeth) {
  std::mt19937_64 random(3);
  for (int i = 0; i < 60; ++i) {
    auto [cut, modes] = test::random_case(random);
    const double speed = rpm_to_rad_s(4000 + 100 * i), depth = 1e-3;
    if (i % 3 == 0) cut.lag_per_depth = 0.4 / depth;
    if (i % 4 == 0) cut.process_damping = 3e3;
    if (i % 5 == 0) cut.shape = ToolShape::ball;
    const FloquetPoint tooth = floquet_point(cut, modes, speed, depth);
    cut.pitch.assign(static_cast<std::size_t>(cut.teeth), kTwoPi / cut.teeth);
    const FloquetPoint turn = floquet_point(cut, modes, speed, depth);
    const double expected = std::pow(tooth.spectral_radius, cut.teeth);
    EXPECT_NEAR(turn.spectral_radius, expected, 1e-6 * std::max(1.0, expected)) << "cut " << i;
    EXPECT_NEAR(turn.period, cut.teeth * tooth.period, 1e-15);
  }
}

TEST(SeveralDelays, WhichToothIsCountedFirstChangesNothing) {
  std::mt19937_64 random(6);
  for (int i = 0; i < 20; ++i) {
    auto [cut, modes] = test::random_uneven_case(random, 720);
    const double speed = rpm_to_rad_s(3000 + 200 * i);
    const double before = floquet_point(cut, modes, speed, 1e-3).spectral_radius;
    std::rotate(cut.pitch.begin(), cut.pitch.begin() + 1, cut.pitch.end());
    EXPECT_NEAR(floquet_point(cut, modes, speed, 1e-3).spectral_radius, before, 1e-6 * std::max(1.0, before));
  }
}

// What variable pitch is for: at the speed where equal teeth regenerate worst, pitches that put the delays half a wave
// apart cut deeper.
TEST(SeveralDelays, PitchTunedToTheModeLiftsTheLimit) {
  auto [cut, modes] = test::reference_case("a", 0.5, Milling::down);
  cut.teeth = 4;
  const double speed = rpm_to_rad_s(5000);
  const double equal = floquet_depth_limit(cut, modes, speed, {}).depth;
  const double wave = kTwoPi * speed / modes[0].natural_frequency;  // spindle angle of one vibration
  const double shift = 0.25 * wave;
  cut.pitch = {kTwoPi / 4 - shift, kTwoPi / 4 + shift, kTwoPi / 4 - shift, kTwoPi / 4 + shift};
  EXPECT_GT(floquet_depth_limit(cut, modes, speed, {}).depth, 1.5 * equal);
}

}  // namespace
}  // namespace stillcut
