#include "models/period_map.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "models/eigenvalues.hpp"
#include "models/period_operator.hpp"
#include "stability_cases.hpp"

namespace stillcut {
namespace {

// The operator written out, and its eigenvalues found by another method.
double radius(const test::StabilityCase& cutting, double speed, double depth, const Collocation& collocation) {
  const PeriodMap map = period_map(cutting.cut, cutting.modes, speed, depth, depth, collocation);
  PeriodOperator march;
  march.set(map, depth);
  return eigenvalues(test::written_out(march)).cwiseAbs().maxCoeff();
}

TEST(PeriodMap, OrdersConvergeOnRandomCuts) {
  std::mt19937_64 random(7);
  for (int i = 0; i < 40; ++i) {
    const test::StabilityCase cutting = test::random_case(random);
    const double speed = rpm_to_rad_s(std::uniform_real_distribution<>(1500, 15000)(random));
    const double depth = std::uniform_real_distribution<>(1e-4, 2e-3)(random);
    const double fine = radius(cutting, speed, depth, {20.0, 6.0});
    EXPECT_NEAR(radius(cutting, speed, depth, {12.0, 5.0}), fine, 1e-7 * std::max(1.0, fine)) << "cut " << i;
    EXPECT_NEAR(radius(cutting, speed, depth, {7.0, 4.0}), fine, 1e-3 * std::max(1.0, fine)) << "cut " << i;
  }
}

TEST(PeriodMap, ATinyHelixGivesTheStraightTool) {
  std::mt19937_64 random(8);
  for (int i = 0; i < 10; ++i) {
    test::StabilityCase cutting = test::random_case(random);
    const double speed = rpm_to_rad_s(6000), depth = 1e-3;
    const double straight = radius(cutting, speed, depth, {12.0, 5.0});
    cutting.cut.lag_per_depth = 1e-5 / depth;
    EXPECT_NEAR(radius(cutting, speed, depth, {12.0, 5.0}), straight, 1e-3 * straight);
  }
}

TEST(PeriodMap, ATurnOfTheWholePictureChangesNothing) {
  // Stability is a property of the cut: negating every mode's direction leaves it as it is.
  std::mt19937_64 random(9);
  test::StabilityCase cutting = test::random_case(random);
  const double before = radius(cutting, 500.0, 1e-3, {});
  for (Mode& mode : cutting.modes) {
    for (double& component : mode.direction) component = -component;
  }
  EXPECT_NEAR(radius(cutting, 500.0, 1e-3, {}), before, 1e-9);
}

TEST(PeriodMap, ShortStretchesGiveWhatLongOnesGive) {
  std::mt19937_64 random(10);
  for (int i = 0; i < 20; ++i) {
    const test::StabilityCase cutting = test::random_case(random);
    const double speed = rpm_to_rad_s(std::uniform_real_distribution<>(2000, 9000)(random)), depth = 1e-3;
    const double expected = radius(cutting, speed, depth, {14.0, 6.0, 4.0});
    EXPECT_NEAR(radius(cutting, speed, depth, {14.0, 6.0, 0.7}), expected, 1e-9 * std::max(1.0, expected));
  }
}

}  // namespace
}  // namespace stillcut
