#include "models/posture_trend.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "models/machining.hpp"

namespace stillcut {
namespace {

using Eigen::Index;

constexpr double kThin = 0.1;     // of the widest spread: a direction thinner than this carries no slope
constexpr double kRidge = 1e-10;  // of the trace: keeps C invertible where the weights leave it flat

// The posture as seen from the query: joint differences in rad, or the way in m.
Eigen::VectorXd seen_from(const Posture& query, const Posture& posture, bool has_joints, const JointScale& scale) {
  Eigen::VectorXd way(has_joints ? 6 : 3);
  for (Index i = 0; i < way.size(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    way[i] = has_joints ? scale[k] * std::remainder(posture.joints[k] - query.joints[k], kTwoPi)
                        : posture.position[k] - query.position[k];
  }
  return way;
}

// Columns: directions along which the points (rows) spread, `most` at most.
Eigen::MatrixXd wide_directions(const Eigen::MatrixXd& points, Index most) {
  const Eigen::MatrixXd centred = points.rowwise() - points.colwise().mean();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> spread(centred.transpose() * centred);
  const Eigen::VectorXd& squares = spread.eigenvalues();  // rising
  const Index size = squares.size();
  Index count = 0;
  while (count < std::min(size, most) && squares[size - 1] > 0.0 &&
         squares[size - 1 - count] >= kThin * kThin * squares[size - 1]) {
    ++count;
  }
  return spread.eigenvectors().rightCols(count);
}

}  // namespace

std::vector<double> trend_weights(const DynamicsMap& map, const Posture& query, std::span<const double> weights,
                                  const JointScale& scale) {
  std::vector<std::size_t> used;
  double sum = 0.0;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    if (weights[i] > 0.0) used.push_back(i);
    sum += weights[i];
  }
  std::vector<double> result(weights.begin(), weights.end());
  for (double& weight : result) weight /= sum;
  if (used.size() < 3) return result;
  double squares = 0.0;
  for (const double weight : result) squares += weight * weight;

  const auto count = static_cast<Index>(used.size());
  Eigen::MatrixXd points(count, map.has_joints ? 6 : 3);
  Eigen::VectorXd w(count);
  for (Index r = 0; r < count; ++r) {
    const std::size_t i = used[static_cast<std::size_t>(r)];
    points.row(r) = seen_from(query, map.postures[i], map.has_joints, scale);
    w[r] = result[i] * result[i] / squares;
  }
  const Eigen::MatrixXd x = points * wide_directions(points, (count - 1) / 2);
  if (x.cols() == 0) return result;
  const Eigen::RowVectorXd mean = w.transpose() * x;
  const Eigen::MatrixXd off = x.rowwise() - mean;
  Eigen::MatrixXd covariance = off.transpose() * w.asDiagonal() * off;
  if (!(covariance.trace() > 0.0)) return result;
  covariance.diagonal().array() += kRidge * covariance.trace();
  const Eigen::VectorXd slope = covariance.ldlt().solve(mean.transpose());
  for (Index r = 0; r < count; ++r) result[used[static_cast<std::size_t>(r)]] = w[r] * (1.0 - off.row(r).dot(slope));
  return result;
}

int spread_directions(const DynamicsMap& map, const JointScale& scale) {
  if (map.postures.empty()) return 0;
  Eigen::MatrixXd points(static_cast<Index>(map.postures.size()), map.has_joints ? 6 : 3);
  for (Index r = 0; r < points.rows(); ++r)
    points.row(r) =
        seen_from(map.postures.front(), map.postures[static_cast<std::size_t>(r)], map.has_joints, scale).transpose();
  return static_cast<int>(wide_directions(points, points.cols()).cols());
}

}  // namespace stillcut
