// The Gaussian filter by its defining property: half of a wave as long as the cutoff passes, whichever way it runs.
#include "models/surface_filter.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "dsp/numbers.hpp"
#include "models/surface_roughness.hpp"
#include "tests/models/surface_maps.hpp"

namespace stillcut {
namespace {

// Transmission of the Gaussian: exp(-π (α λ_c/λ)²), α² = ln 2/π.
double passes(double cutoff_in_waves) { return std::exp2(-cutoff_in_waves * cutoff_in_waves); }

TEST(Waviness, PassesOfAWaveInAProfileWhatTheStandardSays) {
  constexpr double kCutoff = 0.8e-3, kSpacing = 4e-6;
  for (const double ratio : {0.5, 1.0, 2.0}) {  // cutoff over wavelength
    std::vector<double> profile;
    const double wave = kCutoff / ratio;
    for (int i = 0; i <= 2000; ++i) profile.push_back(std::cos(2.0 * std::numbers::pi * (i - 1000) * kSpacing / wave));
    EXPECT_NEAR(waviness(profile, kSpacing, kCutoff)[1000], passes(ratio), 1e-4) << ratio;
  }
}

// Fails where the two directions are mixed up (their spacings differ), or the bell is not round.
TEST(Waviness, PassesHalfOfAWaveOfTheCutoffAlongAcrossAndAslant) {
  constexpr double kCutoff = 0.2e-3;
  for (const double angle : {0.0, 0.5 * std::numbers::pi, 0.6}) {
    const HeightMap map = surface_of(201, 161, 4e-6, 5e-6, [&](double x, double y) {
      const double way = (x - 0.4e-3) * std::cos(angle) + (y - 0.4e-3) * std::sin(angle);
      return std::cos(2.0 * std::numbers::pi * way / kCutoff);
    });
    EXPECT_NEAR(waviness(map, kCutoff).at(100, 80), 0.5, 1e-3) << angle;
  }
}

TEST(Roughness, KeepsHalfOfAWaveOfTheCutoff) {
  constexpr double kCutoff = 0.4e-3;
  const HeightMap map = surface_of(1000, 1000, 4e-6, 4e-6, [&](double x, double y) {
    return 1e-6 * std::cos(2.0 * std::numbers::pi * (x + 2e-6) / kCutoff) +
           1e-6 * std::cos(2.0 * std::numbers::pi * (y + 2e-6) / kCutoff);
  });
  const RoughnessSettings filtered{.cutoff = kCutoff};
  EXPECT_NEAR(mean_roughness(map, ProfileDirection::along, filtered).mean.rq, 0.5e-6 / std::sqrt(2.0), 0.01e-6);
  EXPECT_NEAR(mean_roughness(map, ProfileDirection::across, filtered).mean.rq, 0.5e-6 / std::sqrt(2.0), 0.01e-6);
  EXPECT_NEAR(areal_roughness(map, filtered).sq, 0.5e-6, 0.01e-6);
}

// Weights that do not sum to 1 at ends and holes would bend what is level.
TEST(Waviness, OfALevelSurfaceWithHolesIsLevelUpToTheEnds) {
  HeightMap map = surface_of(60, 50, 4e-6, 5e-6, [](double, double) { return 3e-6; });
  for (std::size_t k = 0; k < map.heights.size(); k += 11) map.heights[k] = kNaN;
  const HeightMap waves = waviness(map, 0.1e-3);
  for (std::size_t k = 0; k < map.heights.size(); ++k) {
    ASSERT_EQ(std::isnan(waves.heights[k]), std::isnan(map.heights[k]));
    if (std::isnan(map.heights[k])) continue;
    ASSERT_NEAR(waves.heights[k], 3e-6, 1e-18);
  }
}

}  // namespace
}  // namespace stillcut
