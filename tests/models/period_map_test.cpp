#include "models/period_map.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <stdexcept>

#include "models/gauss_legendre.hpp"
#include "models/modal_response.hpp"
#include "stability_cases.hpp"

namespace stillcut {
namespace {

double radius(const test::StabilityCase& cutting, double speed, double depth, const Collocation& collocation) {
  const PeriodMap map = period_map(cutting.cut, cutting.modes, speed, depth, collocation);
  return Eigen::EigenSolver<Eigen::MatrixXd>(monodromy(map, depth), false).eigenvalues().cwiseAbs().maxCoeff();
}

TEST(GaussLegendre, IntegratesPolynomialsOfTwiceItsOrderExactly) {
  for (const int count : {1, 2, 5, 12, 40}) {
    const GaussLegendre rule = gauss_legendre(count);
    for (int degree = 0; degree < 2 * count; ++degree) {
      EXPECT_NEAR((rule.weights.array() * rule.nodes.array().pow(degree)).sum(), 1.0 / (degree + 1), 1e-13) << count;
    }
  }
  EXPECT_THROW(gauss_legendre(0), std::invalid_argument);
}

TEST(GaussLegendre, LagrangeBasisReproducesPolynomials) {
  const GaussLegendre rule = gauss_legendre(9);
  const Eigen::VectorXd points = Eigen::VectorXd::LinSpaced(17, 0.0, 1.0);
  const Eigen::VectorXd values = lagrange_basis(rule.nodes, points) * rule.nodes.array().pow(8).matrix();
  EXPECT_LT((values - points.array().pow(8).matrix()).cwiseAbs().maxCoeff(), 1e-13);
  EXPECT_TRUE(lagrange_basis(rule.nodes, rule.nodes).isIdentity());
}

TEST(ModalResponse, ToAConstantForceIsTheStepResponse) {
  const Oscillator mode(test::mode_of(120, 0.04, 5e6, 1, 0));
  const ForcedStretch stretch(14);
  const double duration = 0.011;
  const ModalResponse response = stretch.respond(mode, duration);
  // From rest under a unit force: q = (1 - free decay from q = 1)/k.
  for (Eigen::Index i = 0; i < stretch.size(); ++i) {
    const double expected = (1.0 - mode.transition(duration * stretch.node(i))(0, 0)) / 5e6;
    EXPECT_NEAR(response.at_node[static_cast<std::size_t>(i)].row(0).sum(), expected, 1e-12 / 5e6);
  }
  EXPECT_NEAR(response.end.row(0).sum(), (1.0 - mode.transition(duration)(0, 0)) / 5e6, 1e-12 / 5e6);
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

}  // namespace
}  // namespace stillcut
