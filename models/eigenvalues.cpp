#include "models/eigenvalues.hpp"

#include <Eigen/Eigenvalues>

namespace stillcut {

Eigen::VectorXcd eigenvalues(const Eigen::MatrixXd& matrix) {
  return Eigen::EigenSolver<Eigen::MatrixXd>(matrix, false).eigenvalues();
}

}  // namespace stillcut
