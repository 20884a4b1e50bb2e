// All eigenvalues of a real square matrix. Here alone, because the solver takes a compiler half a minute to meet.
#pragma once

#include <Eigen/Core>

namespace stillcut {

Eigen::VectorXcd eigenvalues(const Eigen::MatrixXd& matrix);

}  // namespace stillcut
