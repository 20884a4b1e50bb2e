// Roughness of walls whose profile is known.
#include "models/wall_roughness.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace stillcut {
namespace {

constexpr double kWallRadius = 10e-3;

TEST(WallRoughness, OfFeedMarksAloneIsTheirArcs) {
  // Arcs of radius R at distance f: height f^2/(8R), mean deviation of a parabola 4/(9 sqrt 3) of it.
  constexpr double kFeed = 0.4e-3;
  std::vector<ToothPass> passes;
  for (int i = 0; i < 100; ++i) passes.push_back({i * kFeed, 0.0});
  const double height = kFeed * kFeed / (8.0 * kWallRadius);
  EXPECT_NEAR(wall_roughness(passes, kWallRadius), 4.0 / (9.0 * std::sqrt(3.0)) * height, 0.02 * height);
}

// A wave less curved than the tool is left as it is; the tool bridges the valleys of a sharper one.
TEST(WallRoughness, OfAGentleWaveIsTheWaves) {
  constexpr double kWave = 0.4e-3, kHigh = 1e-7;  // two waves a sampling length
  std::vector<ToothPass> passes;
  for (int i = 0; i < 4000; ++i)
    passes.push_back({i * 2e-6, kHigh * std::sin(2.0 * std::numbers::pi * i * 2e-6 / kWave)});
  EXPECT_NEAR(wall_roughness(passes, kWallRadius), 2.0 / std::numbers::pi * kHigh, 0.1 * kHigh);
}

TEST(WallRoughness, LeavesFormOut) {
  std::vector<ToothPass> passes;
  for (int i = 0; i < 500; ++i) passes.push_back({i * 20e-6, 1e-3 * i * 20e-6});  // a slope of 1 in 1000
  EXPECT_LT(wall_roughness(passes, kWallRadius), 5e-9);
}

TEST(WallRoughness, OfRunoutShowsOnlyTheToothThatReachesDeepest) {
  std::vector<ToothPass> both, deep;
  for (int i = 0; i < 200; ++i) {
    both.push_back({i * 50e-6, i % 2 == 0 ? 5e-6 : -5e-6});
    if (i % 2 == 0) deep.push_back({i * 50e-6, 5e-6});
  }
  EXPECT_NEAR(wall_roughness(both, kWallRadius), wall_roughness(deep, kWallRadius), 1e-9);
}

TEST(WallRoughness, OfAShortWallOrNoneIsUnknown) {
  EXPECT_TRUE(std::isnan(wall_roughness({}, kWallRadius)));
  const std::vector<ToothPass> two{{0.0, 0.0}, {50e-6, 0.0}};
  EXPECT_TRUE(std::isnan(wall_roughness(two, kWallRadius)));
}

}  // namespace
}  // namespace stillcut
