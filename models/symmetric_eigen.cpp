#include "models/symmetric_eigen.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace stillcut {
namespace {

constexpr int kMostSweeps = 50;    // fewer than ten are needed
constexpr double kNoRest = 1e-17;  // off the diagonal, of the matrix's norm

// Turns rows and columns p and q of a symmetric matrix so that its element (p, q) is gone; `turns` gathers the turns.
void jacobi_turn(JointMatrix& matrix, JointMatrix& turns, Eigen::Index p, Eigen::Index q) {
  if (matrix(p, q) == 0.0) return;
  const double theta = (matrix(q, q) - matrix(p, p)) / (2.0 * matrix(p, q));
  const double t = (theta < 0.0 ? -1.0 : 1.0) / (std::abs(theta) + std::hypot(1.0, theta));
  const double c = 1.0 / std::hypot(1.0, t), s = t * c;
  const auto turn = [&](auto&& one, auto&& other) {
    const JointVector kept = one;
    one = c * kept - s * JointVector(other);
    other = s * kept + c * JointVector(other);
  };
  turn(matrix.col(p), matrix.col(q));
  turn(matrix.row(p).transpose(), matrix.row(q).transpose());
  turn(turns.col(p), turns.col(q));
}

}  // namespace

SymmetricEigen symmetric_eigen(JointMatrix matrix) {
  const Eigen::Index n = matrix.rows();
  JointMatrix turns = JointMatrix::Identity(n, n);
  const double scale = matrix.norm();
  for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
    double rest = 0.0;
    for (Eigen::Index q = 1; q < n; ++q) rest = std::max(rest, matrix.col(q).head(q).cwiseAbs().maxCoeff());
    if (!(rest > kNoRest * scale)) break;
    for (Eigen::Index q = 1; q < n; ++q) {
      for (Eigen::Index p = 0; p < q; ++p) jacobi_turn(matrix, turns, p, q);
    }
  }
  SymmetricEigen eigen{matrix.diagonal(), turns};
  for (Eigen::Index r = 0; r + 1 < n; ++r) {  // the smallest of those that are left comes next
    Eigen::Index least = 0;
    eigen.values.tail(n - r).minCoeff(&least);
    std::swap(eigen.values[r], eigen.values[r + least]);
    eigen.vectors.col(r).swap(eigen.vectors.col(r + least));
  }
  return eigen;
}

}  // namespace stillcut
