// Gauss-Legendre nodes on [0, 1] and what collocation on them needs: the integral of a kernel against a polynomial that
// is known by its values at the nodes.
#pragma once

#include <Eigen/Core>

namespace stillcut {

struct GaussLegendre {
  Eigen::VectorXd nodes;    // rising, inside (0, 1)
  Eigen::VectorXd weights;  // sum 1
};

// Exact for polynomials of degree 2 count - 1. Throws std::invalid_argument for count < 1.
GaussLegendre gauss_legendre(int count);

// Values at the points of the Lagrange polynomials through the nodes: points x nodes.
Eigen::MatrixXd lagrange_basis(const Eigen::VectorXd& nodes, const Eigen::VectorXd& points);

}  // namespace stillcut
