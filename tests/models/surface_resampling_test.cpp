// Resampled height maps: the same surface on another grid.
#include "models/surface_resampling.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "dsp/numbers.hpp"
#include "models/surface_sweep.hpp"
#include "tests/models/surface_maps.hpp"

namespace stillcut {
namespace {

// Breaks where the ends do not meet, where a spacing is of points instead of cells, where x and y are mixed up.
TEST(Resampling, OfABilinearSurfaceIsExact) {
  const auto heights = [](double x, double y) { return 2e-6 + 3e-3 * x - 1e-3 * y + 5.0 * x * y; };
  const HeightMap map = surface_of(13, 8, 5e-6, 7e-6, heights);
  const HeightMap other = resampled(map, 10, 21);
  ASSERT_EQ(other.along, 10u);
  ASSERT_EQ(other.across, 21u);
  EXPECT_NEAR(other.spacing_along, 12 * 5e-6 / 9, 1e-18);
  EXPECT_NEAR(other.spacing_across, 7 * 7e-6 / 20, 1e-18);
  for (std::size_t j = 0; j < other.across; ++j)
    for (std::size_t i = 0; i < other.along; ++i)
      EXPECT_NEAR(other.at(i, j),
                  heights(static_cast<double>(i) * other.spacing_along, static_cast<double>(j) * other.spacing_across),
                  1e-18);
}

TEST(Resampling, KeepsThePointsThatBothGridsHaveToTheBit) {
  const HeightMap map = noise_map(7, 9, 1e-6, 1), same = resampled(map, 7, 9), coarse = resampled(map, 4, 5);
  EXPECT_EQ(same.heights, map.heights);
  EXPECT_EQ(same.spacing_along, map.spacing_along);
  for (std::size_t j = 0; j < 5; ++j)
    for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(coarse.at(i, j), map.at(2 * i, 2 * j));
}

// Breaks where a hole is filled, and where it grows over points that stand beside it.
TEST(Resampling, LeavesHolesOpen) {
  HeightMap map = noise_map(5, 5, 1e-6, 1);
  map.at(1, 1) = kNaN;
  const HeightMap fine = resampled(map, 9, 9);
  for (std::size_t j = 0; j < 9; ++j)
    for (std::size_t i = 0; i < 9; ++i)
      EXPECT_EQ(std::isnan(fine.at(i, j)), i > 0 && i < 4 && j > 0 && j < 4) << i << ' ' << j;
  EXPECT_THROW((void)resampled(map, 1, 5), std::invalid_argument);
  EXPECT_THROW((void)resampled(resampled(map, 2, 2), 0, 2), std::invalid_argument);
}

TEST(UncutMap, HasAPointMoreThanCells) {
  const HeightMap map = uncut_map(2e-3, 1e-3, std::size_t{500}, std::size_t{100});
  EXPECT_EQ(map.along, 501u);
  EXPECT_EQ(map.across, 101u);
  EXPECT_DOUBLE_EQ(map.spacing_along, 4e-6);
  EXPECT_DOUBLE_EQ(map.spacing_across, 10e-6);
  EXPECT_TRUE(std::isnan(map.at(500, 100)));
  EXPECT_THROW((void)uncut_map(2e-3, 1e-3, std::size_t{0}, std::size_t{100}), std::invalid_argument);
  EXPECT_THROW((void)uncut_map(2e-3, -1e-3, std::size_t{5}, std::size_t{5}), std::invalid_argument);
}

}  // namespace
}  // namespace stillcut
