#include "models/gauss_legendre.hpp"

#include <cmath>
#include <numbers>
#include <stdexcept>

namespace stillcut {

GaussLegendre gauss_legendre(int count) {
  if (count < 1) throw std::invalid_argument("Gauss-Legendre rule: needs at least one node");
  GaussLegendre rule{Eigen::VectorXd(count), Eigen::VectorXd(count)};
  for (int i = 0; i < count; ++i) {
    // Newton on the Legendre polynomial from Tricomi's estimate of its roots: converges to rounding in a few steps.
    double x = -std::cos(std::numbers::pi * (i + 0.75) / (count + 0.5));
    double slope = 1.0;
    for (int step = 0; step < 8; ++step) {
      double previous = 1.0, value = x;
      for (int k = 2; k <= count; ++k) {
        const double next = ((2 * k - 1) * x * value - (k - 1) * previous) / k;
        previous = value;
        value = next;
      }
      slope = count * (x * value - previous) / (x * x - 1.0);
      x -= value / slope;
    }
    rule.nodes[i] = 0.5 * (1.0 + x);
    rule.weights[i] = 1.0 / ((1.0 - x * x) * slope * slope);
  }
  return rule;
}

Eigen::MatrixXd lagrange_basis(const Eigen::VectorXd& nodes, const Eigen::VectorXd& points) {
  const Eigen::Index count = nodes.size();
  Eigen::VectorXd barycentric = Eigen::VectorXd::Ones(count);
  for (Eigen::Index j = 0; j < count; ++j) {
    for (Eigen::Index k = 0; k < count; ++k) {
      if (k != j) barycentric[j] /= 4.0 * (nodes[j] - nodes[k]);  // 4: capacity of [0, 1], keeps the product in range
    }
  }
  Eigen::MatrixXd basis(points.size(), count);
  for (Eigen::Index i = 0; i < points.size(); ++i) {
    const Eigen::ArrayXd distance = points[i] - nodes.array();
    Eigen::Index nearest;
    if (distance.abs().minCoeff(&nearest) == 0.0) {
      basis.row(i).setZero();
      basis(i, nearest) = 1.0;
    } else {
      const Eigen::ArrayXd terms = barycentric.array() / distance;
      basis.row(i) = (terms / terms.sum()).matrix();
    }
  }
  return basis;
}

}  // namespace stillcut
