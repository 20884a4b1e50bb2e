// The a-priori rule for the number of nodes: what each level promises holds on random cuts, robots and reference cases,
// against a far finer solution.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "models/floquet.hpp"
#include "stability_cases.hpp"

namespace stillcut {
namespace {

std::vector<double> errors(int level, int cuts, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto uniform = [&](double low, double high) { return std::uniform_real_distribution<>(low, high)(random); };
  std::vector<double> result;
  for (int i = 0; i < cuts; ++i) {
    const char* named[] = {"a", "b", "c_feed30"};
    const test::StabilityCase cutting =
        i % 2 == 0 ? test::random_case(random)
                   : test::reference_case(named[i / 2 % 3], i % 8 == 1 ? 1.0 : uniform(0.05, 1.0),
                                          i % 4 == 1 ? Milling::down : Milling::up);
    const double speed = rpm_to_rad_s(uniform(2000, 25000));
    const double depth = std::exp(uniform(std::log(5e-5), std::log(8e-3)));
    const double fine = CutAtSpeed(cutting.cut, cutting.modes, speed, kFinestLevel).radius(depth, 1e-11);
    const double coarse = CutAtSpeed(cutting.cut, cutting.modes, speed, level).radius(depth, 1e-11);
    result.push_back(std::abs(coarse - fine) / std::max(1.0, fine));
  }
  std::sort(result.begin(), result.end());
  return result;
}

TEST(StabilityResolution, LevelZeroKeepsTenToTheMinusFive) {
  const auto found = errors(0, 400, 77);
  EXPECT_LT(found[found.size() / 2], 1e-7);
  EXPECT_LT(found[found.size() * 99 / 100], 1e-5);
  EXPECT_LT(found.back(), 1e-4);
}

TEST(StabilityResolution, LevelOneKeepsTenToTheMinusEight) {
  const auto found = errors(1, 400, 78);
  EXPECT_LT(found[found.size() * 99 / 100], 1e-8);
  EXPECT_LT(found.back(), 1e-6);
}

}  // namespace
}  // namespace stillcut
