#include "models/gauss_legendre.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

namespace stillcut {
namespace {

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

}  // namespace
}  // namespace stillcut
