// Texture of surfaces that repeat as often as we say.
#include "models/surface_texture.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "dsp/numbers.hpp"
#include "models/surface_roughness.hpp"
#include "tests/models/surface_maps.hpp"

namespace stillcut {
namespace {

// Intervals between the resolved frequencies: reading off the nearest one would miss them by up to 5 %.
TEST(TextureInterval, IsFoundBetweenTheResolvedFrequencies) {
  constexpr double kLength = 2e-3;
  for (const double repeats : {2.5, 3.3, 7.37, 20.62}) {
    const double interval = kLength / repeats;
    const HeightMap map = surface_of(200, 500, 10e-6, 4e-6, [&](double x, double y) {
      return scallop(y, interval, 5e-6) + 1e-6 * std::cos(2.0 * std::numbers::pi * x / 0.3e-3);
    });
    const TextureInterval across = texture_interval(texture_spectrum(map, ProfileDirection::across));
    EXPECT_NEAR(across.interval, interval, (repeats < 3.0 ? 0.03 : 0.005) * interval) << repeats;
    EXPECT_GT(across.share, 0.8);
    const TextureInterval along = texture_interval(texture_spectrum(map, ProfileDirection::along));
    EXPECT_NEAR(along.interval, 0.3e-3, 0.002 * 0.3e-3);
    EXPECT_GT(along.share, 0.95);
  }
}

TEST(TextureInterval, OutlastsNoiseAndHolesAndATilt) {
  HeightMap map = noise_map(400, 300, 2e-6, 1);
  for (std::size_t j = 0; j < map.across; ++j)
    for (std::size_t i = 0; i < map.along; ++i)
      map.at(i, j) += 1e-6 * std::sin(2.0 * std::numbers::pi * static_cast<double>(i) * 4e-6 / 0.11e-3) +
                      0.01 * static_cast<double>(i) * 4e-6;
  for (std::size_t k = 0; k < map.heights.size(); k += 23) map.heights[k] = kNaN;
  for (std::size_t i = 0; i < 100; ++i) map.at(i, 7) = kNaN;
  const TextureSpectrum spectrum = texture_spectrum(map, ProfileDirection::along);
  EXPECT_EQ(spectrum.left_out, 1U);
  EXPECT_EQ(spectrum.profiles, 299U);
  EXPECT_NEAR(texture_interval(spectrum).interval, 0.11e-3, 0.005 * 0.11e-3);
}

TEST(TextureInterval, OfNoiseHasAlmostNoShareAndOfAFlatSurfaceIsNone) {
  EXPECT_LT(texture_interval(texture_spectrum(noise_map(400, 300, 1e-6, 2), ProfileDirection::along)).share, 0.05);
  const HeightMap flat = surface_of(50, 50, 1e-5, 1e-5, [](double, double) { return 0.0; });
  EXPECT_TRUE(std::isnan(texture_interval(texture_spectrum(flat, ProfileDirection::along)).interval));
}

// A bow is form, not texture, though it is a hundred times higher.
TEST(TextureInterval, IsNotThatOfABow) {
  const HeightMap bow = surface_of(200, 20, 1e-5, 1e-5, [](double x, double) {
    return 3.0 * x * x + 1e-7 * std::sin(2.0 * std::numbers::pi * x / 0.17e-3);
  });
  const TextureInterval found = texture_interval(texture_spectrum(bow, ProfileDirection::along));
  EXPECT_NEAR(found.interval, 0.17e-3, 0.002 * 0.17e-3);
  EXPECT_GT(found.share, 0.9);
}

// Parseval: fails with a wrong window correction, padding or side.
TEST(TextureSpectrum, SumsToTheMeanSquare) {
  for (const HeightMap& map : {noise_map(300, 400, 1e-6, 3), surface_of(300, 400, 4e-6, 5e-6, [](double x, double y) {
                                 return 1e-6 * std::cos(2.0 * std::numbers::pi * (x / 0.1e-3 + y / 0.13e-3));
                               })}) {
    for (const ProfileDirection direction : {ProfileDirection::along, ProfileDirection::across}) {
      const TextureSpectrum spectrum = texture_spectrum(map, direction);
      double sum = 0.0;
      for (const double density : spectrum.densities) sum += density * spectrum.frequencies[1];
      const ArealRoughness area = areal_roughness(map);
      EXPECT_NEAR(sum, area.sq * area.sq, 0.02 * area.sq * area.sq);
      EXPECT_EQ(spectrum.frequencies.size(), spectrum.densities.size());
      EXPECT_NEAR(spectrum.frequencies.back(), 0.5 / profile_spacing(map, direction), 1e-6);
    }
  }
}

TEST(TextureSpectrum, IsRefusedWhereTooLittleIsKnown) {
  EXPECT_THROW((void)texture_spectrum(noise_map(7, 20, 1e-6, 4), ProfileDirection::along), std::invalid_argument);
  HeightMap map = noise_map(20, 20, 1e-6, 5);
  for (std::size_t j = 0; j < 20; ++j)
    for (std::size_t i = 0; i < 3; ++i) map.at(i, j) = kNaN;
  EXPECT_THROW((void)texture_spectrum(map, ProfileDirection::along), std::invalid_argument);
  EXPECT_NO_THROW((void)texture_spectrum(map, ProfileDirection::across));
}

// Fails where a ripple is taken for an element, or one at the end that is not whole.
TEST(MeanElementWidth, IsTheDistanceOfHillsAndLeavesOutRipples) {
  const HeightMap map = surface_of(500, 20, 4e-6, 5e-6, [](double x, double) {
    return 1e-6 * std::sin(2.0 * std::numbers::pi * x / 0.13e-3 + 0.4) +
           0.05e-6 * std::sin(2.0 * std::numbers::pi * x / 0.017e-3) + 0.02 * x;
  });
  EXPECT_NEAR(mean_element_width(map, ProfileDirection::along), 0.13e-3, 0.01 * 0.13e-3);
  EXPECT_TRUE(std::isnan(mean_element_width(map, ProfileDirection::across)));  // level
  // White noise, each point beyond the discrimination with the same chance, up or down: so many points until both came.
  const HeightMap noise = noise_map(4000, 40, 1e-6, 7);
  double chance = 0.0;
  for (std::size_t j = 0; j < noise.across; ++j) {
    const std::vector<double> row = surface_profile(noise, ProfileDirection::along, j);
    const auto [low, high] = std::minmax_element(row.begin(), row.end());
    chance += 0.5 * std::erfc(0.1 * (*high - *low) / 1e-6 / std::sqrt(2.0)) / 40;
  }
  EXPECT_NEAR(mean_element_width(noise, ProfileDirection::along), 2.0 / chance * 4e-6, 0.03 * 2.0 / chance * 4e-6);
}

}  // namespace
}  // namespace stillcut
