#include "models/pole_fractions.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <complex>

#include "models/eigenvalues.hpp"
#include "models/machining.hpp"

namespace stillcut {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kMostPoleDamping = 0.5;
constexpr double kPastTheBand = 1.05;  // where the angle of z is pi, in highest frequencies of the band
constexpr Index kLinesAPair = 3;       // of the band, at least, for a pair of poles

// Polynomials p_0, p_1, … in x, by x p_k = up_k p_(k+1) + down_k p_(k-1).
struct Polynomials {
  VectorXd up, down;
  double first = 1.0;  // p_0

  Eigen::VectorXcd at(Complex x) const {
    Eigen::VectorXcd values(up.size() + 1);
    values[0] = first;
    for (Index k = 0; k < up.size(); ++k)
      values[k + 1] = (x * values[k] - (k > 0 ? down[k] * values[k - 1] : Complex())) / up[k];
    return values;
  }
};

// The linear problem: the denominator's coefficients d make d^T reduced d least, every entry's numerator has the
// coefficients numerators * d.
struct FractionProblem {
  MatrixXd reduced;
  std::vector<MatrixXd> numerators;
  Polynomials denominator_basis;
  std::vector<Polynomials> numerator_bases;
};

// Sums over the lines of weight * factor * z^lag, lag = 0 … order; z^-lag is its conjugate.
Eigen::VectorXcd lag_sums(const Eigen::VectorXcd& z, const Eigen::VectorXcd& factors, Index order) {
  Eigen::VectorXcd sums(order + 1), turned = factors;
  for (Index lag = 0; lag <= order; ++lag) {
    sums[lag] = turned.sum();
    turned.array() *= z.array();
  }
  return sums;
}

FractionProblem lscf_problem(const FrfLines& band, const FrfWeights& weights, Index order, double period) {
  FractionProblem problem;
  problem.reduced = MatrixXd::Zero(order + 1, order + 1);
  problem.denominator_basis = {VectorXd::Ones(order), VectorXd::Zero(order), 1.0};
  Eigen::VectorXcd z(band.omega.size());
  for (Index n = 0; n < z.size(); ++n) z[n] = std::polar(1.0, -band.omega[n] * period);
  for (std::size_t e = 0; e < band.entries.size(); ++e) {
    const Eigen::VectorXcd& values = band.entries[e].values;
    const Eigen::VectorXcd plain = weights[e].cast<Complex>(), once = plain.cwiseProduct(values);
    const Eigen::VectorXcd back = once.conjugate();
    const Eigen::VectorXcd r = lag_sums(z, plain, order), s = lag_sums(z, once, order),
                           s_back = lag_sums(z, back, order),
                           t = lag_sums(z, once.cwiseProduct(values.conjugate()), order);
    MatrixXd rr(order + 1, order + 1), ss = rr, tt = rr;
    for (Index k = 0; k <= order; ++k)
      for (Index l = 0; l <= order; ++l) {
        const Index lag = std::abs(k - l);
        rr(k, l) = r[lag].real();
        tt(k, l) = t[lag].real();
        // conj(z^k) H z^l: z^(l-k) H; where k > l the conjugate of z^(k-l) conj(H)
        ss(k, l) = l >= k ? s[lag].real() : s_back[lag].real();
      }
    rr.diagonal().array() *= 1.0 + 1e-13;
    MatrixXd numerator = rr.ldlt().solve(ss);
    problem.reduced += tt - ss.transpose() * numerator;
    problem.numerators.push_back(std::move(numerator));
    problem.numerator_bases.push_back(problem.denominator_basis);
  }
  return problem;
}

// Forsythe's recurrence over the lines and their mirror images at negative frequency, by which p_k(i w) is i^k times a
// real number. `x`: w over the highest. The table has that real number.
Polynomials forsythe(const VectorXd& x, const VectorXd& weights, Index order, MatrixXd& table) {
  Polynomials basis{VectorXd(order), VectorXd::Zero(order), 0.0};
  table.resize(x.size(), order + 1);
  basis.first = 1.0 / std::sqrt(2.0 * weights.sum());
  table.col(0).setConstant(basis.first);
  for (Index k = 0; k < order; ++k) {
    VectorXd next = x.cwiseProduct(table.col(k));
    if (k > 0) next -= basis.up[k - 1] * table.col(k - 1);
    // Once more against what rounding left of the others.
    for (Index l = k - 1; l >= 0; l -= 2) next -= 2.0 * (weights.cwiseProduct(next)).dot(table.col(l)) * table.col(l);
    basis.up[k] = std::sqrt(2.0 * weights.dot(next.cwiseAbs2()));
    table.col(k + 1) = next / basis.up[k];
    if (k > 0) basis.down[k] = -basis.up[k - 1];  // i^(k+1) = -i^(k-1)
  }
  return basis;
}

MatrixXcd with_powers_of_i(const MatrixXd& table) {
  MatrixXcd result = table.cast<Complex>();
  constexpr std::array<Complex, 4> kPowers{Complex(1, 0), Complex(0, 1), Complex(-1, 0), Complex(0, -1)};
  for (Index k = 0; k < result.cols(); ++k) result.col(k) *= kPowers[static_cast<std::size_t>(k % 4)];
  return result;
}

FractionProblem polynomial_problem(const FrfLines& band, const FrfWeights& weights, Index order) {
  FractionProblem problem;
  const VectorXd x = band.omega / band.omega[band.omega.size() - 1];
  VectorXd together = VectorXd::Zero(x.size());
  for (std::size_t e = 0; e < band.entries.size(); ++e)
    together += weights[e].cwiseProduct(band.entries[e].values.cwiseAbs2());
  MatrixXd table;
  problem.denominator_basis = forsythe(x, together, order, table);
  const MatrixXcd denominator = with_powers_of_i(table);
  problem.reduced = MatrixXd::Identity(order + 1, order + 1);
  for (std::size_t e = 0; e < band.entries.size(); ++e) {
    problem.numerator_bases.push_back(forsythe(x, weights[e], order, table));
    const Eigen::VectorXcd factor = band.entries[e].values.cwiseProduct(weights[e].cast<Complex>());
    MatrixXd numerator = 2.0 * (with_powers_of_i(table).adjoint() * factor.asDiagonal() * denominator).real();
    problem.reduced -= numerator.transpose() * numerator;
    problem.numerators.push_back(std::move(numerator));
  }
  return problem;
}

// Coefficients of the denominator of an order, the highest 1.
VectorXd denominator_of(const FractionProblem& problem, Index order) {
  VectorXd d(order + 1);
  d[order] = 1.0;
  const MatrixXd free = problem.reduced.topLeftCorner(order, order);
  d.head(order) = -free.ldlt().solve(problem.reduced.col(order).head(order));
  return d;
}

// The zeros are the eigenvalues of multiplication by x, modulo the polynomial.
Eigen::VectorXcd zeros_of(const VectorXd& d, const Polynomials& basis) {
  const Index order = d.size() - 1;
  MatrixXd times(order, order);
  times.setZero();
  for (Index k = 0; k < order; ++k) {
    if (k > 0) times(k, k - 1) = basis.down[k];
    if (k + 1 < order)
      times(k, k + 1) = basis.up[k];
    else
      times.row(k) -= basis.up[k] / d[order] * d.head(order).transpose();
  }
  return eigenvalues(times);
}

}  // namespace

std::vector<std::vector<FractionPole>> fraction_poles(const FrfLines& band, const FrfWeights& weights, int most_pairs,
                                                      PoleMethod method) {
  std::vector<std::vector<FractionPole>> rows;
  const Index lines = band.omega.size();
  const Index pairs = std::min<Index>(most_pairs, lines / kLinesAPair);
  if (pairs < 1) return rows;
  const double top = band.omega[lines - 1];
  const double period = 0.5 * kTwoPi / (kPastTheBand * top);
  const bool lscf = method == PoleMethod::lscf;
  const FractionProblem problem =
      lscf ? lscf_problem(band, weights, 2 * pairs, period) : polynomial_problem(band, weights, 2 * pairs);
  for (Index pair = 1; pair <= pairs; ++pair) {
    const VectorXd d = denominator_of(problem, 2 * pair);
    std::vector<FractionPole>& row = rows.emplace_back();
    if (!d.allFinite()) continue;
    for (const Complex x : zeros_of(d, problem.denominator_basis)) {
      const Complex s = lscf ? -std::log(x) / period : x * top;
      const double frequency = std::abs(s), damping = -s.real() / frequency;
      if (!(s.imag() > 0.0) || !(damping > 0.0) || !(damping < kMostPoleDamping)) continue;
      FractionPole& pole = row.emplace_back(
          FractionPole{{frequency, damping}, Eigen::VectorXcd(static_cast<Index>(band.entries.size()))});
      for (std::size_t e = 0; e < band.entries.size(); ++e) {
        const Eigen::VectorXcd powers = problem.numerator_bases[e].at(x);
        const VectorXd numerator = problem.numerators[e].leftCols(2 * pair + 1) * d;
        pole.shape[static_cast<Index>(e)] = powers.cwiseProduct(numerator.cast<Complex>()).sum();
      }
      pole.shape.normalize();
    }
    std::sort(row.begin(), row.end(), [](const FractionPole& a, const FractionPole& b) {
      return a.pole.natural_frequency < b.pole.natural_frequency;
    });
  }
  return rows;
}

}  // namespace stillcut
