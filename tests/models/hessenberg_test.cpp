#include "models/hessenberg.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "models/eigenvalues.hpp"

namespace stillcut {
namespace {

Eigen::MatrixXd random_hessenberg(std::mt19937_64& random, int order, double decay) {
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(order, order);
  for (int j = 0; j < order; ++j) {
    for (int i = 0; i <= std::min(order - 1, j + 1); ++i) {
      matrix(i, j) = std::normal_distribution<>()(random) * std::pow(decay, i);
    }
  }
  return matrix;
}

TEST(Hessenberg, LargestEigenvalueAgreesWithEigen) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 3000; ++i) {
    const int order = 1 + i % 32;
    const Eigen::MatrixXd matrix = random_hessenberg(random, order, i % 3 == 0 ? 1.0 : 0.4);
    const double expected = eigenvalues(matrix).cwiseAbs().maxCoeff();
    Eigen::MatrixXd work = matrix;
    const std::complex<double> found = largest_eigenvalue_of_hessenberg(work.data(), order);
    EXPECT_NEAR(std::abs(found), expected, 1e-11 * expected) << "order " << order;
    EXPECT_GE(found.imag(), 0.0);
  }
}

TEST(Hessenberg, KnowsTheSpecialOnes) {
  double zero[] = {0.0, 0.0, 0.0, 0.0};
  EXPECT_EQ(largest_eigenvalue_of_hessenberg(zero, 2), 0.0);
  double turn[] = {0.0, 1.0, -1.0, 0.0};  // by a quarter
  EXPECT_NEAR(std::abs(largest_eigenvalue_of_hessenberg(turn, 2) - std::complex<double>(0.0, 1.0)), 0.0, 1e-15);
  // A cyclic shift, where plain shifts of the QR steps stand still: all eigenvalues lie on the unit circle.
  for (const int order : {3, 4, 7}) {
    Eigen::MatrixXd cycle = Eigen::MatrixXd::Zero(order, order);
    for (int i = 0; i + 1 < order; ++i) cycle(i + 1, i) = 1.0;
    cycle(0, order - 1) = 1.0;
    EXPECT_NEAR(std::abs(largest_eigenvalue_of_hessenberg(cycle.data(), order)), 1.0, 1e-12);
  }
}

}  // namespace
}  // namespace stillcut
