#include "models/modal_polish.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <complex>

namespace stillcut {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::Vector3d;

constexpr int kParameters = 5;  // of a mode: log frequency, log damping ratio, v
constexpr int kEntries = 6;     // of a symmetric tensor
constexpr int kMostSteps = 40;
constexpr double kLeastGain = 1e-4;   // relative gain in the sum of squares below which it ends
constexpr double kLargestMove = 0.3;  // of a logarithm in one step
constexpr double kMostDamping = 0.95;

struct Normal {
  Eigen::MatrixXd hessian;   // J^T J
  Eigen::VectorXd gradient;  // J^T r
  double squares = 0.0;
};

// Upper triangle; entries off the diagonal stand twice in the tensor.
template <class Matrix>
auto entries(const Matrix& g) {
  const double twice = std::sqrt(2.0);
  Eigen::Matrix<typename Matrix::Scalar, kEntries, 1> e;
  e << g(0, 0), g(1, 1), g(2, 2), twice * g(0, 1), twice * g(0, 2), twice * g(1, 2);
  return e;
}

Vector3d root_of_compliance(const Mode& mode) {
  return Vector3d(mode.direction.data()).normalized() / std::sqrt(mode.stiffness);
}

struct Target {
  std::span<const double> frequencies;
  std::span<const Eigen::Matrix3cd> responses;
};

double sum_of_squares(std::span<const Mode> modes, const Target& target, Normal* normal) {
  const Index size = static_cast<Index>(modes.size()) * kParameters;
  if (normal) {
    normal->hessian.setZero(size, size);
    normal->gradient.setZero(size);
  }
  Eigen::Matrix<double, 2 * kEntries, Eigen::Dynamic> rows(2 * kEntries, size);
  double squares = 0.0;
  for (std::size_t f = 0; f < target.frequencies.size(); ++f) {
    const Eigen::Matrix3cd& wanted = target.responses[f];
    const double weight = 1.0 / wanted.norm();
    Eigen::Matrix<Complex, kEntries, 1> off = -entries(wanted);
    for (std::size_t m = 0; m < modes.size(); ++m) {
      const Mode& mode = modes[m];
      const double ratio = target.frequencies[f] / mode.natural_frequency;
      const Complex h = 1.0 / Complex(1.0 - ratio * ratio, 2.0 * mode.damping_ratio * ratio);
      const Vector3d v = root_of_compliance(mode);
      const Eigen::Matrix<double, kEntries, 1> shape = entries((v * v.transpose()).eval());
      off += h * shape;
      if (!normal) continue;
      const Complex by_frequency = h * h * Complex(-2.0 * ratio * ratio, 2.0 * mode.damping_ratio * ratio);
      const Complex by_damping = h * h * Complex(0.0, -2.0 * mode.damping_ratio * ratio);
      Eigen::Matrix<Complex, kEntries, kParameters> change;
      change.col(0) = by_frequency * shape;
      change.col(1) = by_damping * shape;
      for (Index k = 0; k < 3; ++k) {
        const Eigen::Matrix3d turn = Vector3d::Unit(k) * v.transpose() + v * Vector3d::Unit(k).transpose();
        change.col(2 + k) = h * entries(turn);
      }
      rows.middleCols(static_cast<Index>(m) * kParameters, kParameters) << weight * change.real(),
          weight * change.imag();
    }
    off *= weight;
    squares += off.squaredNorm();
    if (!normal) continue;
    Eigen::Matrix<double, 2 * kEntries, 1> residual;
    residual << off.real(), off.imag();
    normal->hessian.selfadjointView<Eigen::Lower>().rankUpdate(rows.transpose());
    normal->gradient += rows.transpose() * residual;
  }
  if (normal) {
    normal->hessian = normal->hessian.selfadjointView<Eigen::Lower>();
    normal->squares = squares;
  }
  return squares;
}

std::vector<Mode> moved(std::vector<Mode> modes, const Eigen::VectorXd& step) {
  for (std::size_t m = 0; m < modes.size(); ++m) {
    const auto by = step.segment<kParameters>(static_cast<Index>(m) * kParameters);
    Mode& mode = modes[m];
    mode.natural_frequency *= std::exp(std::clamp(by[0], -kLargestMove, kLargestMove));
    mode.damping_ratio =
        std::min(kMostDamping, mode.damping_ratio * std::exp(std::clamp(by[1], -kLargestMove, kLargestMove)));
    const Vector3d v = root_of_compliance(mode) + by.tail<3>();
    if (!(v.squaredNorm() > 0.0)) continue;
    mode.stiffness = 1.0 / v.squaredNorm();
    Eigen::Map<Vector3d>(mode.direction.data()) = v.normalized();
  }
  return modes;
}

}  // namespace

std::vector<Mode> polish_modes(std::vector<Mode> modes, std::span<const double> frequencies,
                               std::span<const Eigen::Matrix3cd> responses) {
  const Target target{frequencies, responses};
  Normal normal;
  double damping = 1e-3;
  for (int step = 0; step < kMostSteps; ++step) {
    const double before = sum_of_squares(modes, target, &normal);
    bool gained = false;
    for (int attempt = 0; attempt < 12 && !gained; ++attempt) {
      Eigen::MatrixXd damped = normal.hessian;
      damped.diagonal() += damping * normal.hessian.diagonal();
      const std::vector<Mode> next = moved(modes, -damped.ldlt().solve(normal.gradient));
      const double after = sum_of_squares(next, target, nullptr);
      if (after < before) {
        gained = true;
        modes = next;
        damping = std::max(1e-12, damping * 0.2);
        if (before - after < kLeastGain * before) return modes;
      } else {
        damping *= 5.0;
      }
    }
    if (!gained) break;
  }
  return modes;
}

}  // namespace stillcut
