#include "models/cut_stability.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "stability_cases.hpp"

namespace stillcut {
namespace {

TEST(CutStability, VerdictTurnsAtTheLimitDepth) {
  std::mt19937_64 random(11);
  int met = 0;
  while (met < 20) {
    const test::StabilityCase cutting = test::random_case(random);
    const double speed = rpm_to_rad_s(std::uniform_real_distribution<>(3000, 12000)(random));
    const DepthLimit limit = floquet_depth_limit(cutting.cut, cutting.modes, speed, {.max_depth = 0.02});
    if (!std::isfinite(limit.depth)) continue;
    ++met;
    const auto verdict = [&](double share) {
      return cut_stability(cutting.cut, cutting.modes, speed, share * limit.depth).verdict;
    };
    EXPECT_EQ(verdict(0.9), Verdict::stable);
    EXPECT_EQ(verdict(0.97), Verdict::near_limit);
    EXPECT_EQ(verdict(1.0), Verdict::near_limit);
    EXPECT_EQ(verdict(1.03), Verdict::near_limit);
    EXPECT_NE(verdict(1.1), Verdict::stable);  // a narrow unstable stretch may end here
  }
}

TEST(CutStability, AtDepthZeroTheStructureRingsFreely) {
  std::mt19937_64 random(12);
  for (int i = 0; i < 20; ++i) {
    const test::StabilityCase cutting = test::random_case(random);
    const double speed = rpm_to_rad_s(std::uniform_real_distribution<>(3000, 12000)(random));
    const CutStability free = cut_stability(cutting.cut, cutting.modes, speed, 0.0);
    double slowest = 1e300;
    for (const Mode& mode : cutting.modes) slowest = std::min(slowest, mode.damping_ratio * mode.natural_frequency);
    EXPECT_NEAR(free.point.period, kTwoPi / (speed * cutting.cut.teeth), 1e-15);
    EXPECT_NEAR(free.point.spectral_radius, std::exp(-slowest * free.point.period), 1e-6);
    EXPECT_EQ(free.verdict, Verdict::stable);
  }
}

TEST(CutStability, RefusesWhatIsNoCut) {
  const test::StabilityCase cutting = test::reference_case("a", 0.5, Milling::down);
  EXPECT_THROW(cut_stability(cutting.cut, cutting.modes, 0.0, 1e-3), std::invalid_argument);
  EXPECT_THROW(cut_stability(cutting.cut, cutting.modes, 500.0, -1e-3), std::invalid_argument);
}

}  // namespace
}  // namespace stillcut
