#include "models/lobe_trace.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "models/lobes.hpp"
#include "models/stability_field.hpp"
#include "stability_cases.hpp"

namespace stillcut {
namespace {

struct Range {
  test::StabilityCase cutting;
  double low_rpm, high_rpm, max_depth;
};

std::vector<Range> ranges() {
  std::vector<Range> result;
  for (const double ratio : {0.05, 0.5, 1.0}) {
    result.push_back(
        {test::reference_case("a", ratio, ratio < 1.0 ? Milling::down : Milling::slot), 5000, 25000, 5e-3});
  }
  for (const char* name : {"c_feed0", "c_feed30", "c_feed90"}) {
    result.push_back({test::reference_case(name, 0.5, Milling::down), 2800, 3800, 20e-3});
  }
  std::mt19937_64 random(5);
  for (int i = 0; i < 12; ++i) result.push_back({test::random_case(random), 3000, 9000, 5e-3});
  return result;
}

// Every traced limit against a search of its own, made without the neighbours and at a finer resolution.
TEST(LobeTrace, AgreesWithTheFullSearchAtEverySpeed) {
  int finite = 0, stable = 0;
  for (const Range& range : ranges()) {
    const auto& [cut, modes] = range.cutting;
    const auto speeds = equally_spaced_speeds(rpm_to_rad_s(range.low_rpm), rpm_to_rad_s(range.high_rpm), 121);
    const auto traced = traced_depth_limits(cut, modes, speeds, {.max_depth = range.max_depth});
    ASSERT_EQ(traced.size(), speeds.size());
    for (std::size_t i = 0; i < speeds.size(); ++i) {
      const DepthLimit full = floquet_depth_limit(cut, modes, speeds[i], {.max_depth = range.max_depth});
      if (std::isfinite(full.depth)) {
        EXPECT_NEAR(traced[i].depth, full.depth, 2e-3 * full.depth) << rad_s_to_rpm(speeds[i]) << " rpm";
        EXPECT_LT(traced[i].error_estimate, 2e-3);
        ++finite;
      } else {
        EXPECT_EQ(std::isnan(traced[i].depth), std::isnan(full.depth));
        EXPECT_FALSE(std::isfinite(traced[i].depth)) << rad_s_to_rpm(speeds[i]) << " rpm: " << traced[i].depth;
        ++stable;
      }
    }
  }
  EXPECT_GT(finite, 900);
  EXPECT_GT(stable, 200);
}

TEST(LobeTrace, RefusesWhatIsNoSearchAndGivesNothingForNoSpeeds) {
  const auto [cut, modes] = test::reference_case("a", 0.5, Milling::down);
  EXPECT_TRUE(traced_depth_limits(cut, modes, {}, {}).empty());
  const double speeds[] = {500.0, 0.0};
  EXPECT_THROW(traced_depth_limits(cut, modes, speeds, {}), std::invalid_argument);
  EXPECT_THROW(traced_depth_limits(cut, modes, std::span(speeds, 1), {.max_depth = -1.0}), std::invalid_argument);
}

// All verdicts of a diagram against the radius at every point; points within a whisker of the boundary may differ, and
// islands of a few points may be missed.
TEST(StabilityField, FollowedVerdictsAreThoseOfTheRadius) {
  for (const Range& range : ranges()) {
    const auto& [cut, modes] = range.cutting;
    const auto speeds = equally_spaced_speeds(rpm_to_rad_s(range.low_rpm), rpm_to_rad_s(range.high_rpm), 100);
    std::vector<double> depths;
    for (int k = 1; k <= 60; ++k) depths.push_back(range.max_depth * k / 60);
    const auto radii = spectral_radii(cut, modes, speeds, depths);
    const auto stable = stable_cuts(cut, modes, speeds, depths);
    ASSERT_EQ(radii.size(), 6000u);
    ASSERT_EQ(stable.size(), 6000u);
    int differ = 0;
    for (std::size_t i = 0; i < radii.size(); ++i) {
      differ += std::abs(radii[i] - 1.0) > 1e-4 && (radii[i] < 1.0) != (stable[i] == 1);
    }
    EXPECT_LE(differ, 12);
  }
}

TEST(StabilityField, RadiiAreThoseOfSinglePoints) {
  const auto [cut, modes] = test::reference_case("c_feed45", 0.5, Milling::down);
  const double speeds[] = {300.0, 350.0}, depths[] = {1e-3, 2e-3, 5e-3};
  const auto radii = spectral_radii(cut, modes, speeds, depths);
  ASSERT_EQ(radii.size(), 6u);
  for (std::size_t i = 0; i < 6; ++i) {
    const double expected = floquet_point(cut, modes, speeds[i / 3], depths[i % 3]).spectral_radius;
    EXPECT_NEAR(radii[i], expected, 2e-5 * std::max(1.0, expected));
  }
}

}  // namespace
}  // namespace stillcut
