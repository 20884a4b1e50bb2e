#include "models/likelihood_fit.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace stillcut {
namespace {

using Eigen::Index;

constexpr double kSeenShare = 1e-12;  // of the largest variance: below, an axis is one that no entry shows

// Parameters in units of their own spread, so that the matrix is as well conditioned as it can be; those that no entry
// shows are left out of it.
struct ScaledInformation {
  Eigen::VectorXd scale;  // 0: not shown
  Eigen::MatrixXd matrix;

  explicit ScaledInformation(const Eigen::MatrixXd& information) : scale(information.rows()) {
    for (Index p = 0; p < scale.size(); ++p)
      scale[p] = information(p, p) > 0.0 ? 1.0 / std::sqrt(information(p, p)) : 0.0;
    matrix = scale.asDiagonal() * information * scale.asDiagonal();
    for (Index p = 0; p < scale.size(); ++p)
      if (scale[p] == 0.0) matrix(p, p) = 1.0;
  }

  Eigen::VectorXd solve(const Eigen::VectorXd& gradient, double damping) const {
    Eigen::MatrixXd damped = matrix;
    damped.diagonal().array() += damping;
    return scale.cwiseProduct(damped.ldlt().solve(scale.cwiseProduct(gradient)));
  }

  Eigen::MatrixXd inverse() const {
    const Eigen::MatrixXd plain = matrix.ldlt().solve(Eigen::MatrixXd::Identity(matrix.rows(), matrix.cols()));
    return scale.asDiagonal() * plain * scale.asDiagonal();
  }
};

// The vector a whose products a_i a_j come nearest to the residues of the entries, each with its weight: coordinate by
// coordinate, from every axis that can be the first.
Eigen::Vector3d root_of(const std::vector<FrfEntry>& entries, const Eigen::VectorXd& residues,
                        const Eigen::VectorXd& weights) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero(), weight = sum;
  for (std::size_t e = 0; e < entries.size(); ++e) {
    const auto k = static_cast<Index>(e);
    for (const auto& [i, j] :
         {std::array{entries[e].response, entries[e].force}, std::array{entries[e].force, entries[e].response}}) {
      sum(i, j) += 0.5 * weights[k] * residues[k];
      weight(i, j) += 0.5 * weights[k];
    }
  }
  const auto cost = [&](const Eigen::Vector3d& a) {
    double total = 0.0;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) total += weight(i, j) * a[i] * a[i] * a[j] * a[j] - 2.0 * sum(i, j) * a[i] * a[j];
    return total;
  };
  Eigen::Vector3d best = Eigen::Vector3d::Zero();
  const double size = residues.cwiseAbs().maxCoeff();
  for (int signs = 0; signs < 4; ++signs)
    for (int strong = 0; strong < 3; ++strong) {
      Eigen::Vector3d a = Eigen::Vector3d::Constant(0.3 * std::sqrt(size));
      a[strong] = std::sqrt(size);
      if (signs & 1) a[(strong + 1) % 3] *= -1.0;
      if (signs & 2) a[(strong + 2) % 3] *= -1.0;
      for (int axis = 0; axis < 3; ++axis)
        if (weight.row(axis).sum() == 0.0) a[axis] = 0.0;
      for (int sweep = 0; sweep < 60; ++sweep)
        for (int i = 0; i < 3; ++i) {
          if (weight.row(i).sum() == 0.0) continue;
          // d cost/d a_i / 4: w_ii a_i^3 + (sum_j w_ij a_j^2 - s_ii) a_i - sum_j s_ij a_j; Newton's steps
          double linear = -sum(i, i), constant = 0.0;
          for (int j = 0; j < 3; ++j) {
            if (j == i) continue;
            linear += weight(i, j) * a[j] * a[j];
            constant += sum(i, j) * a[j];
          }
          for (int step = 0; step < 4; ++step) {
            const double slope = 3.0 * weight(i, i) * a[i] * a[i] + linear;
            if (!(std::abs(slope) > 0.0)) break;
            a[i] -= (weight(i, i) * a[i] * a[i] * a[i] + linear * a[i] - constant) /
                    std::max(slope, 0.1 * std::abs(slope) + std::numeric_limits<double>::min());
          }
        }
      if (a.allFinite() && cost(a) < cost(best)) best = a;
    }
  return best;
}

}  // namespace

LikelihoodFit fit_likelihood(ModalModel start, const FrfLines& lines, const FrfWeights& weights,
                             const FitEffort& effort) {
  LikelihoodFit fit{std::move(start), 0.0, {}};
  NormalEquations normal = normal_equations(fit.model, lines, weights);
  double damping = 1e-4;
  bool settled = false;
  for (int step = 0; step < effort.most_steps && !settled; ++step) {
    const ScaledInformation information(normal.information);
    settled = true;
    for (int attempt = 0; attempt < 12; ++attempt) {
      ModalModel next = moved(fit.model, information.solve(normal.gradient, damping));
      const double chi = chi_square(next, lines, weights);
      if (chi < normal.chi_square) {
        settled = normal.chi_square - chi < std::max(effort.least_gain, effort.least_share * chi);
        fit.model = std::move(next);
        damping = std::max(1e-12, 0.1 * damping);
        break;
      }
      damping = std::max(1e-6, 8.0 * damping);
    }
    normal = normal_equations(fit.model, lines, weights);
  }
  fit.chi_square = normal.chi_square;
  fit.covariance = ScaledInformation(normal.information).inverse();
  return fit;
}

ModalModel model_of_poles(const std::vector<Pole>& poles, const FrfLines& lines, const FrfWeights& weights) {
  const auto count = static_cast<Index>(poles.size());
  const Index rows = lines.omega.size();
  Eigen::MatrixXd columns(2 * rows, count);
  for (Index r = 0; r < count; ++r) {
    const Eigen::VectorXcd response = pole_response(poles[static_cast<std::size_t>(r)], lines.omega);
    columns.col(r) << response.real(), response.imag();
  }
  const auto entries = static_cast<Index>(lines.entries.size());
  Eigen::MatrixXd residues(count, entries), information(count, entries);
  for (Index e = 0; e < entries; ++e) {
    const auto k = static_cast<std::size_t>(e);
    Eigen::VectorXd root(2 * rows), values(2 * rows);
    root.head(rows) = root.tail(rows) = weights[k].cwiseSqrt();
    values << lines.entries[k].values.real(), lines.entries[k].values.imag();
    const Eigen::MatrixXd weighted = root.asDiagonal() * columns;
    const Eigen::MatrixXd gram = weighted.transpose() * weighted;
    const ScaledInformation scaled(gram);
    residues.col(e) = scaled.solve(weighted.transpose() * root.cwiseProduct(values), 1e-12);
    information.col(e) = gram.diagonal();
  }
  ModalModel model;
  for (Index r = 0; r < count; ++r) {
    const Eigen::VectorXd residue = residues.row(r), weight = information.row(r);
    // In units in which the numbers are about 1.
    const double scale = std::max(residue.cwiseAbs().maxCoeff(), std::numeric_limits<double>::min());
    const double heavy = std::max(weight.maxCoeff(), std::numeric_limits<double>::min());
    model.terms.push_back({poles[static_cast<std::size_t>(r)],
                           std::sqrt(scale) * root_of(lines.entries, residue / scale, weight / heavy)});
  }
  return model;
}

double significance(const LikelihoodFit& fit, std::size_t term) {
  const Eigen::Index p = kTermParameters * static_cast<Index>(term) + 2;
  const Eigen::Vector3d a = fit.model.terms[term].root;
  const Eigen::Matrix3d covariance = fit.covariance.block<3, 3>(p, p);
  double sum = 0.0;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(covariance);
  for (int k = 0; k < 3; ++k)
    if (const double variance = eigen.eigenvalues()[k]; variance > kSeenShare * eigen.eigenvalues()[2]) {
      const double along = eigen.eigenvectors().col(k).dot(a);
      sum += along * along / variance;
    }
  return sum;
}

double size_deviation(const LikelihoodFit& fit, std::size_t term) {
  const Eigen::Index p = kTermParameters * static_cast<Index>(term) + 2;
  const Eigen::Vector3d a = fit.model.terms[term].root;
  return std::sqrt(std::max(0.0, a.dot(fit.covariance.block<3, 3>(p, p) * a))) / a.squaredNorm();
}

}  // namespace stillcut
