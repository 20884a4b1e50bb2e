#include "models/leading_multiplier.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "models/eigenvalues.hpp"
#include "models/period_operator.hpp"
#include "stability_cases.hpp"

namespace stillcut {
namespace {

class DenseMap final : public LinearMap {
 public:
  explicit DenseMap(Eigen::MatrixXd matrix) : matrix_(std::move(matrix)) {}
  [[nodiscard]] int size() const override { return static_cast<int>(matrix_.rows()); }
  void apply(const double* in, double* out) const override {
    Eigen::Map<Eigen::VectorXd>(out, matrix_.rows()) = matrix_ * Eigen::Map<const Eigen::VectorXd>(in, matrix_.cols());
  }
  [[nodiscard]] double radius() const { return eigenvalues(matrix_).cwiseAbs().maxCoeff(); }

 private:
  Eigen::MatrixXd matrix_;
};

TEST(Arnoldi, FindsTheLeadingEigenvalueOfSmallMatrices) {
  std::mt19937_64 random(2);
  Arnoldi arnoldi;
  for (int i = 0; i < 200; ++i) {
    const int size = 1 + i % 20;
    const DenseMap map(Eigen::MatrixXd::NullaryExpr(size, size, [&] { return std::normal_distribution<>()(random); }));
    EXPECT_NEAR(std::abs(arnoldi.leading(map, size, 1e-12).value), map.radius(), 1e-9 * map.radius());
  }
}

TEST(Arnoldi, OfTheZeroMapIsZero) {
  EXPECT_EQ(Arnoldi().leading(DenseMap(Eigen::MatrixXd::Zero(5, 5)), 3, 1e-9).value, 0.0);
}

TEST(Arnoldi, FindsTheLeadingMultiplierOfCutsAndItsVector) {
  std::mt19937_64 random(3);
  Arnoldi arnoldi;
  for (int i = 0; i < 300; ++i) {
    const test::StabilityCase cutting = test::random_case(random);
    const double speed = rpm_to_rad_s(std::uniform_real_distribution<>(1500, 15000)(random));
    const double depth = std::exp(std::uniform_real_distribution<>(std::log(1e-5), std::log(1e-2))(random));
    const PeriodMap map = period_map(cutting.cut, cutting.modes, speed, depth, depth, {7.0, 4.0, 1.5});
    PeriodOperator march;
    march.set(map, depth);
    const Eigen::MatrixXd matrix = test::written_out(march);
    const double expected = eigenvalues(matrix).cwiseAbs().maxCoeff();
    const int least = 2 * static_cast<int>(cutting.modes.size()) + 4;
    const auto leading = arnoldi.leading(march, least, 1e-7);
    EXPECT_NEAR(std::abs(leading.value), expected, 1e-6 * std::max(1.0, expected)) << "cut " << i;
    const auto vector = arnoldi.eigenvector(march.size());
    const Eigen::Map<const Eigen::VectorXcd> v(vector.data(), march.size());
    const double residual = (matrix.cast<std::complex<double>>() * v - leading.value * v).norm();
    EXPECT_LT(residual, 1e-3 * v.norm() * std::max(1.0, expected)) << "cut " << i;
  }
}

}  // namespace
}  // namespace stillcut
