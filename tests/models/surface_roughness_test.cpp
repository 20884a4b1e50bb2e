// Roughness of surfaces whose parameters are known in closed form, and what may not change them.
#include "models/surface_roughness.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "dsp/numbers.hpp"
#include "tests/models/surface_maps.hpp"

namespace stillcut {
namespace {

constexpr double kPi = std::numbers::pi;

// Whole waves of 200 points, the same read backwards: their least-squares line is level. Amplitude a share of 1 µm.
std::vector<double> waves(const std::vector<double>& amplitudes) {
  std::vector<double> profile;
  for (const double amplitude : amplitudes)
    for (int i = 0; i < 200; ++i) profile.push_back(amplitude * 1e-6 * std::cos(2.0 * kPi * (i + 0.5) / 200.0));
  return profile;
}

// Fails with a wrong norm, sign or power in any of the sums.
TEST(ProfileRoughness, OfAWave) {
  const ProfileRoughness r = profile_roughness(waves(std::vector<double>(10, 1.0)), 1e-6);
  EXPECT_NEAR(r.ra, 2e-6 / kPi, 1e-10);
  EXPECT_NEAR(r.rq, 1e-6 / std::sqrt(2.0), 1e-10);
  EXPECT_NEAR(r.rt, 2e-6, 1e-9);
  EXPECT_NEAR(r.rz, 2e-6, 1e-9);
  EXPECT_NEAR(r.rsk, 0.0, 1e-9);
  EXPECT_NEAR(r.rku, 1.5, 1e-9);
  EXPECT_EQ(r.unknown, 0U);
}

// Heights h u², u from -1 to 1: mean h/3, from which all follows. The sign of R_sk tells cusps from grooves.
TEST(ProfileRoughness, OfScallops) {
  constexpr double kHeight = 3e-6, kStep = 0.4e-3;
  const HeightMap map = surface_of(5, 4000, 1e-5, 1e-6, [&](double, double y) { return scallop(y, kStep, kHeight); });
  const MeanRoughness across = mean_roughness(map, ProfileDirection::across);
  EXPECT_EQ(across.profiles, 5U);
  EXPECT_NEAR(across.mean.ra / kHeight, 4.0 / (9.0 * std::sqrt(3.0)), 1e-3);
  EXPECT_NEAR(across.mean.rq / kHeight, 2.0 / (3.0 * std::sqrt(5.0)), 1e-3);
  EXPECT_NEAR(across.mean.rt / kHeight, 1.0, 1e-2);
  EXPECT_NEAR(across.mean.rsk, 2.0 * std::sqrt(5.0) / 7.0, 5e-3);
  EXPECT_NEAR(across.mean.rku, 15.0 / 7.0, 1e-2);
  const ArealRoughness area = areal_roughness(map);
  EXPECT_NEAR(area.sa, across.mean.ra, 1e-9);
  EXPECT_NEAR(area.sq, across.mean.rq, 1e-9);
  EXPECT_NEAR(area.ssk, across.mean.rsk, 1e-3);
  EXPECT_NEAR(area.sz, across.mean.rt, 1e-9);
  const MeanRoughness along = mean_roughness(map, ProfileDirection::along);
  EXPECT_EQ(along.profiles, 4000U);
  EXPECT_LT(along.mean.ra, 1e-18);
  EXPECT_TRUE(std::isnan(along.mean.rku));  // rounding has no shape
}

TEST(ArealRoughness, OfNoiseIsGaussian) {
  const ArealRoughness r = areal_roughness(noise_map(500, 400, 1e-6, 1));
  EXPECT_NEAR(r.sq, 1e-6, 1e-8);
  EXPECT_NEAR(r.sa, std::sqrt(2.0 / kPi) * 1e-6, 1e-8);
  EXPECT_NEAR(r.ssk, 0.0, 0.03);
  EXPECT_NEAR(r.sku, 3.0, 0.06);
  EXPECT_GT(r.sz, 8e-6);
}

// Fails where R_z is R_t, or sampling lengths are not fifths.
TEST(ProfileRoughness, RzIsTheMeanOverSamplingLengths) {
  const ProfileRoughness fifths = profile_roughness(waves({1, 2, 3, 2, 1}), 1e-6);
  EXPECT_NEAR(fifths.rz, 2.0 * 9.0 / 5.0 * 1e-6, 1e-9);
  EXPECT_NEAR(fifths.rt, 6e-6, 1e-9);
}

TEST(ProfileRoughness, RzTakesTheCutoffForSamplingLength) {
  std::vector<double> amplitudes;  // ten waves a sampling length: the filter lets all of them through
  for (const double amplitude : {1, 2, 3, 4, 4, 3, 2, 1}) amplitudes.insert(amplitudes.end(), 10, amplitude);
  const ProfileRoughness r = profile_roughness(waves(amplitudes), 1e-6, {.cutoff = 2e-3});
  EXPECT_NEAR(r.rz, 5e-6, 0.03e-6);
  EXPECT_NEAR(r.rt, 8e-6, 0.03e-6);
}

void expect_same(const ArealRoughness& a, const ArealRoughness& b) {
  EXPECT_NEAR(a.sa, b.sa, 1e-9 * b.sa);
  EXPECT_NEAR(a.sq, b.sq, 1e-9 * b.sq);
  EXPECT_NEAR(a.sz, b.sz, 1e-9 * b.sz);
  EXPECT_NEAR(a.ssk, b.ssk, 1e-7);
  EXPECT_NEAR(a.sku, b.sku, 1e-7);
}

void expect_same(const ProfileRoughness& a, const ProfileRoughness& b) {
  EXPECT_NEAR(a.ra, b.ra, 1e-9 * b.ra);
  EXPECT_NEAR(a.rq, b.rq, 1e-9 * b.rq);
  EXPECT_NEAR(a.rt, b.rt, 1e-9 * b.rt);
  EXPECT_NEAR(a.rz, b.rz, 1e-9 * b.rz);
  EXPECT_NEAR(a.rsk, b.rsk, 1e-7);
  EXPECT_NEAR(a.rku, b.rku, 1e-7);
  EXPECT_EQ(a.unknown, b.unknown);
}

HeightMap with_holes(HeightMap map) {
  for (std::size_t k = 0; k < map.heights.size(); k += 7) map.heights[k] = kNaN;
  return map;
}

template <class Heights>
HeightMap plus(HeightMap map, Heights heights) {
  for (std::size_t j = 0; j < map.across; ++j)
    for (std::size_t i = 0; i < map.along; ++i)
      map.at(i, j) += heights(static_cast<double>(i) * map.spacing_along, static_cast<double>(j) * map.spacing_across);
  return map;
}

TEST(Roughness, DoesNotSeeAPlaneWithHolesOrWithout) {
  const auto plane = [](double x, double y) { return 2e-4 + 0.03 * x - 0.07 * y; };
  for (const HeightMap& map : {noise_map(60, 80, 1e-6, 2), with_holes(noise_map(60, 80, 1e-6, 3))}) {
    expect_same(areal_roughness(plus(map, plane)), areal_roughness(map));
    for (const ProfileDirection direction : {ProfileDirection::along, ProfileDirection::across})
      expect_same(mean_roughness(plus(map, plane), direction).mean, mean_roughness(map, direction).mean);
  }
}

TEST(Roughness, DoesNotSeeABentFormWhereAskedSo) {
  const auto bent = [](double x, double y) { return 0.01 * x + 40.0 * x * x - 25.0 * x * y + 60.0 * y * y; };
  const RoughnessSettings quadratic{.form = SurfaceForm::quadratic};
  const HeightMap map = with_holes(noise_map(60, 80, 1e-7, 4));
  expect_same(areal_roughness(plus(map, bent), quadratic), areal_roughness(map, quadratic));
  for (const ProfileDirection direction : {ProfileDirection::along, ProfileDirection::across})
    expect_same(mean_roughness(plus(map, bent), direction, quadratic).mean,
                mean_roughness(map, direction, quadratic).mean);
  EXPECT_GT(areal_roughness(plus(map, bent)).sq, 3.0 * areal_roughness(map).sq);  // a plane leaves it in
}

TEST(MeanRoughness, IsTheMeanOverTheProfiles) {
  const HeightMap map = with_holes(noise_map(31, 42, 1e-6, 5));
  double ra = 0.0, rz = 0.0, rku = 0.0;
  std::size_t unknown = 0;
  for (std::size_t i = 0; i < map.along; ++i) {
    const ProfileRoughness one = profile_roughness(surface_profile(map, ProfileDirection::across, i), 5e-6);
    ra += one.ra / 31.0, rz += one.rz / 31.0, rku += one.rku / 31.0, unknown += one.unknown;
  }
  const MeanRoughness across = mean_roughness(map, ProfileDirection::across);
  EXPECT_NEAR(across.mean.ra, ra, 1e-12 * ra);
  EXPECT_NEAR(across.mean.rz, rz, 1e-12 * rz);
  EXPECT_NEAR(across.mean.rku, rku, 1e-12 * rku);
  EXPECT_EQ(across.mean.unknown, unknown);
  EXPECT_EQ(unknown, 186U);
}

// A guess in place of the holes (zero, a neighbour) would move the figures of a wave less every second point.
TEST(ProfileRoughness, LeavesOutWhatIsNotKnown) {
  std::vector<double> profile = waves(std::vector<double>(10, 1.0)), fewer;
  for (std::size_t k = 0; k < profile.size(); ++k) {
    const bool hole = profile[k] > 0.8e-6 && k % 4 == 1;
    if (!hole) fewer.push_back(profile[k]);
    if (hole) profile[k] = kNaN;
  }
  double mean = 0.0, squares = 0.0;
  for (const double height : fewer) mean += height / static_cast<double>(fewer.size());
  for (const double height : fewer) squares += (height - mean) * (height - mean) / static_cast<double>(fewer.size());
  const ProfileRoughness r = profile_roughness(profile, 1e-6);
  EXPECT_EQ(r.unknown, profile.size() - fewer.size());
  EXPECT_NEAR(r.rq, std::sqrt(squares), 1e-5 * r.rq);
}

TEST(MeanRoughness, LeavesOutAndCountsProfilesThatAreHardlyKnown) {
  const HeightMap whole = noise_map(20, 30, 1e-6, 6);
  HeightMap map = whole;
  for (std::size_t j = 0; j < 16; ++j) map.at(3, j) = kNaN;  // of 30
  const MeanRoughness across = mean_roughness(map, ProfileDirection::across);
  EXPECT_EQ(across.left_out, 1U);
  EXPECT_EQ(across.profiles, 19U);
  EXPECT_EQ(across.mean.unknown, 16U);
  map.at(3, 15) = 0.0;  // half is enough
  EXPECT_EQ(mean_roughness(map, ProfileDirection::across).left_out, 0U);
}

TEST(Roughness, IsRefusedWhereTooLittleIsKnown) {
  const HeightMap sound = noise_map(10, 10, 1e-6, 8);
  const auto refuses = [&](auto spoil) {
    HeightMap map = sound;
    spoil(map);
    EXPECT_THROW((void)areal_roughness(map), std::invalid_argument);
    EXPECT_THROW((void)mean_roughness(map, ProfileDirection::across), std::invalid_argument);
  };
  refuses([](HeightMap& m) { std::fill(m.heights.begin(), m.heights.begin() + 60, kNaN); });
  refuses([](HeightMap& m) { m.heights[5] = kInfinity; });
  refuses([](HeightMap& m) { m.heights.pop_back(); });
  refuses([](HeightMap& m) { m.spacing_along = 0.0; });
  refuses([](HeightMap& m) { m.spacing_across = kNaN; });
  refuses([](HeightMap& m) { m = {}; });
  refuses([](HeightMap& m) { m = noise_map(10, 2, 1e-6, 9), m.heights[3] = m.heights[14] = kInfinity; });
  EXPECT_THROW((void)areal_roughness(noise_map(10, 1, 1e-6, 9)), std::invalid_argument);  // no plane through a line
  EXPECT_THROW((void)profile_roughness(std::vector<double>{1, 2}, 1e-6), std::invalid_argument);
  EXPECT_THROW((void)profile_roughness(std::vector<double>{1, 2, 4}, 1e-6, {.form = SurfaceForm::quadratic}),
               std::invalid_argument);
  EXPECT_THROW((void)profile_roughness(std::vector<double>{1, 2, 4}, 0.0), std::invalid_argument);
  for (const double cutoff : {-1.0, 1e-6, 1.0, kNaN}) {
    EXPECT_THROW((void)areal_roughness(sound, {.cutoff = cutoff}), std::invalid_argument) << cutoff;
    EXPECT_THROW((void)mean_roughness(sound, ProfileDirection::along, {.cutoff = cutoff}), std::invalid_argument);
  }
}

}  // namespace
}  // namespace stillcut
