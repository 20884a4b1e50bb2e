#include "models/modal_model.hpp"

#include <algorithm>
#include <cmath>
#include <complex>

#include "models/multiversion.hpp"

namespace stillcut {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;

constexpr double kLargestLogMove = 0.3;
constexpr double kMostFittedDamping = 0.8;
constexpr Index kLinesAtOnce = 128;  // of the table of basis functions: it stays in the processor's cache

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// sums(c, d) += weighted(n, c) * plain(n, d) over all rows n, for d up to c. `rows` is a multiple of four; sums are of
// four products each, one after the other.
STILLCUT_MULTIVERSION void add_products(const double* weighted, const double* plain, std::size_t rows,
                                        std::size_t width, double* sums) {
  for (std::size_t n = 0; n < rows; n += 4) {
    const double *a = weighted + n * width, *b = a + width, *c = b + width, *d = c + width;
    const double *p = plain + n * width, *q = p + width, *r = q + width, *s = r + width;
    for (std::size_t row = 0; row < width; ++row) {
      double* sum = sums + row * width;
      const double x = a[row], y = b[row], z = c[row], w = d[row];
      for (std::size_t column = 0; column <= row; ++column)
        sum[column] += (x * p[column] + y * q[column]) + (z * r[column] + w * s[column]);
    }
  }
}

// Columns of g, dg/d ln w and dg/d ln zeta of every term, then of inertia and compliance; of every line a row of real
// parts and one of imaginary ones, zero beyond the last line.
struct BasisTable {
  RowMajor rows;
  Index terms = 0, inertia = -1, compliance = -1;

  explicit BasisTable(const ModalModel& model) : terms(static_cast<Index>(model.terms.size())) {
    Index count = 3 * terms;
    if (model.has_inertia) inertia = count++;
    if (model.has_compliance) compliance = count++;
    rows.resize(2 * kLinesAtOnce, count);
  }

  void fill(const ModalModel& model, const FrfLines& lines, Index first, Index count) {
    rows.bottomRows(2 * (kLinesAtOnce - count)).setZero();
    const auto put = [&](Index column, Index n, Complex value) {
      rows(2 * n, column) = value.real();
      rows(2 * n + 1, column) = value.imag();
    };
    for (Index r = 0; r < terms; ++r) {
      const Pole& pole = model.terms[static_cast<std::size_t>(r)].pole;
      for (Index n = 0; n < count; ++n) {
        const double s = lines.omega[first + n] / pole.natural_frequency, d = 2.0 * pole.damping_ratio * s;
        const double real = 1.0 - s * s, scale = 1.0 / (real * real + d * d);
        const Complex g(real * scale, -d * scale);
        const Complex square(g.real() * g.real() - g.imag() * g.imag(), 2.0 * g.real() * g.imag());
        put(3 * r, n, g);
        put(3 * r + 1, n,
            {-2.0 * s * s * square.real() - d * square.imag(), d * square.real() - 2.0 * s * s * square.imag()});
        put(3 * r + 2, n, {d * square.imag(), -d * square.real()});
      }
    }
    for (Index n = 0; n < count; ++n) {
      if (inertia >= 0) put(inertia, n, -1.0 / (lines.omega[first + n] * lines.omega[first + n]));
      if (compliance >= 0) put(compliance, n, 1.0);
    }
  }

  // How much of each column an entry has, and which parameter turns it by how much: rows of columns, columns of
  // parameters.
  Eigen::MatrixXd turns(const ModalModel& model, int i, int j) const {
    Eigen::MatrixXd result = Eigen::MatrixXd::Zero(rows.cols(), parameter_count(model));
    for (Index r = 0; r < terms; ++r) {
      const Eigen::Vector3d& a = model.terms[static_cast<std::size_t>(r)].root;
      const Index p = kTermParameters * r;
      result(3 * r + 1, p) = result(3 * r + 2, p + 1) = a[i] * a[j];
      result(3 * r, p + 2 + i) += a[j];
      result(3 * r, p + 2 + j) += a[i];
    }
    Index p = kTermParameters * terms + symmetric_place(i, j);
    if (inertia >= 0) {
      result(inertia, p) = 1.0;
      p += 6;
    }
    if (compliance >= 0) result(compliance, p) = 1.0;
    return result;
  }

  Eigen::VectorXd shares(const ModalModel& model, int i, int j) const {
    Eigen::VectorXd result = Eigen::VectorXd::Zero(rows.cols());
    for (Index r = 0; r < terms; ++r) {
      const Eigen::Vector3d& a = model.terms[static_cast<std::size_t>(r)].root;
      result[3 * r] = a[i] * a[j];
    }
    if (inertia >= 0) result[inertia] = model.inertia[symmetric_place(i, j)];
    if (compliance >= 0) result[compliance] = model.compliance[symmetric_place(i, j)];
    return result;
  }
};

}  // namespace

Index parameter_count(const ModalModel& model) {
  return kTermParameters * static_cast<Index>(model.terms.size()) + (model.has_inertia ? 6 : 0) +
         (model.has_compliance ? 6 : 0);
}

Eigen::VectorXcd pole_response(const Pole& pole, const Eigen::VectorXd& omega) {
  Eigen::VectorXcd result(omega.size());
  for (Index n = 0; n < omega.size(); ++n) {
    // 1/(x + iy), without the care for overflow that a complex division takes
    const double s = omega[n] / pole.natural_frequency, x = 1.0 - s * s, y = 2.0 * pole.damping_ratio * s;
    const double scale = 1.0 / (x * x + y * y);
    result[n] = {x * scale, -y * scale};
  }
  return result;
}

Eigen::VectorXcd model_values(const ModalModel& model, const Eigen::VectorXd& omega, int i, int j) {
  Eigen::VectorXcd result = Eigen::VectorXcd::Zero(omega.size());
  for (const ModalTerm& term : model.terms)
    if (const double share = term.root[i] * term.root[j]; share != 0.0)
      result += share * pole_response(term.pole, omega);
  const int place = symmetric_place(i, j);
  if (model.has_inertia) result.array() -= model.inertia[place] * omega.array().square().inverse().cast<Complex>();
  if (model.has_compliance) result.array() += Complex(model.compliance[place]);
  return result;
}

std::vector<Eigen::VectorXcd> left_over(const ModalModel& model, const FrfLines& lines) {
  std::vector<Eigen::VectorXcd> result;
  result.reserve(lines.entries.size());
  Eigen::MatrixXcd poles(lines.omega.size(), static_cast<Index>(model.terms.size()));
  for (Index r = 0; r < poles.cols(); ++r)
    poles.col(r) = pole_response(model.terms[static_cast<std::size_t>(r)].pole, lines.omega);
  for (const FrfEntry& entry : lines.entries) {
    Eigen::VectorXcd& rest = result.emplace_back(entry.values);
    for (Index r = 0; r < poles.cols(); ++r) {
      const Eigen::Vector3d& a = model.terms[static_cast<std::size_t>(r)].root;
      rest -= a[entry.response] * a[entry.force] * poles.col(r);
    }
    const int place = symmetric_place(entry.response, entry.force);
    if (model.has_inertia)
      rest.array() += model.inertia[place] * lines.omega.array().square().inverse().cast<Complex>();
    if (model.has_compliance) rest.array() -= Complex(model.compliance[place]);
  }
  return result;
}

double chi_square(const ModalModel& model, const FrfLines& lines, const FrfWeights& weights) {
  const std::vector<Eigen::VectorXcd> rest = left_over(model, lines);
  double sum = 0.0;
  for (std::size_t e = 0; e < rest.size(); ++e) sum += rest[e].cwiseAbs2().dot(weights[e]);
  return sum;
}

NormalEquations normal_equations(const ModalModel& model, const FrfLines& lines, const FrfWeights& weights) {
  BasisTable table(model);
  const Index width = table.rows.cols(), count = lines.omega.size();
  const std::size_t entries = lines.entries.size();
  std::vector<RowMajor> grams(entries, RowMajor::Zero(width, width));
  std::vector<Eigen::VectorXd> slopes(entries, Eigen::VectorXd::Zero(width));
  std::vector<Eigen::VectorXd> shares;
  shares.reserve(entries);
  for (const FrfEntry& entry : lines.entries) shares.push_back(table.shares(model, entry.response, entry.force));
  NormalEquations result;
  RowMajor weighted(2 * kLinesAtOnce, width);
  Eigen::VectorXd rest(2 * kLinesAtOnce), weight(2 * kLinesAtOnce);
  for (Index first = 0; first < count; first += kLinesAtOnce) {
    const Index some = std::min(kLinesAtOnce, count - first);
    table.fill(model, lines, first, some);
    for (std::size_t e = 0; e < entries; ++e) {
      for (Index n = 0; n < kLinesAtOnce; ++n) {
        const std::complex<double> value = n < some ? lines.entries[e].values[first + n] : 0.0;
        weight[2 * n] = weight[2 * n + 1] = n < some ? weights[e][first + n] : 0.0;
        rest[2 * n] = value.real();
        rest[2 * n + 1] = value.imag();
      }
      rest.noalias() -= table.rows * shares[e];
      result.chi_square += rest.cwiseAbs2().dot(weight);
      rest.array() *= weight.array();
      slopes[e].noalias() += table.rows.transpose() * rest;
      weighted = weight.asDiagonal() * table.rows;
      add_products(weighted.data(), table.rows.data(), static_cast<std::size_t>(2 * kLinesAtOnce),
                   static_cast<std::size_t>(width), grams[e].data());
    }
  }
  const Index parameters = parameter_count(model);
  result.information = Eigen::MatrixXd::Zero(parameters, parameters);
  result.gradient = Eigen::VectorXd::Zero(parameters);
  for (std::size_t e = 0; e < entries; ++e) {
    const Eigen::MatrixXd turns = table.turns(model, lines.entries[e].response, lines.entries[e].force);
    const Eigen::MatrixXd gram = grams[e].selfadjointView<Eigen::Lower>();
    result.information.noalias() += turns.transpose() * gram * turns;
    result.gradient.noalias() += turns.transpose() * slopes[e];
  }
  return result;
}

ModalModel moved(ModalModel model, const Eigen::VectorXd& step) {
  Index p = 0;
  for (ModalTerm& term : model.terms) {
    term.pole.natural_frequency *= std::exp(std::clamp(step[p], -kLargestLogMove, kLargestLogMove));
    term.pole.damping_ratio =
        std::min(kMostFittedDamping,
                 term.pole.damping_ratio * std::exp(std::clamp(step[p + 1], -kLargestLogMove, kLargestLogMove)));
    term.root += step.segment<3>(p + 2);
    p += kTermParameters;
  }
  if (model.has_inertia) {
    model.inertia += step.segment<6>(p);
    p += 6;
  }
  if (model.has_compliance) model.compliance += step.segment<6>(p);
  return model;
}

}  // namespace stillcut
