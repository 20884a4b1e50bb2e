#include "models/frf_noise.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>

#include "models/median.hpp"

namespace stillcut {
namespace {

using Eigen::Index;

constexpr Index kNoiseBlock = 64;           // lines that share a median, at least
constexpr double kNoiseBlockGrowth = 0.05;  // of the lines so far: blocks widen with frequency
constexpr Index kLinesForAmounts = 128;     // in every stretch over which frequency grows by a factor e
constexpr int kNoiseSteps = 60;
constexpr double kOutlier = 25.0;  // times the variance: more is no noise, one in 10^11
// While modes are still missing, values are taken for no truer than this (80 dB): the way to the minimum is smoother.
constexpr double kRoughLeastShare = 1e-8;
constexpr double kLeastShare = 1e-13, kLeastUsual = 1e-16;
constexpr int kMostAlike = 32;      // lines apart
constexpr double kNothing = 1e-12;  // of the mean square of the largest entry: no sensor tells so little from none

// First lines of the blocks, and the end.
std::vector<Index> blocks_of(Index count) {
  std::vector<Index> starts{0};
  while (starts.back() < count) {
    const Index first = starts.back();
    Index next = first + std::max(kNoiseBlock, static_cast<Index>(kNoiseBlockGrowth * static_cast<double>(first)));
    if (count - next < kNoiseBlock) next = count;
    starts.push_back(next);
  }
  return starts;
}

// Of squares of Gaussian complex numbers the mean, smooth over the lines: by the medians of the blocks, between their
// middles straight in the logarithm.
Eigen::VectorXd smooth_mean(const Eigen::VectorXd& squares, double least) {
  const Index count = squares.size();
  const std::vector<Index> starts = blocks_of(count);
  std::vector<double> middle, level;
  for (std::size_t b = 0; b + 1 < starts.size(); ++b) {
    const double m = median({squares.data() + starts[b], squares.data() + starts[b + 1]});
    middle.push_back(0.5 * static_cast<double>(starts[b] + starts[b + 1] - 1));
    level.push_back(std::log(std::max(m / std::numbers::ln2, least)));
  }
  Eigen::VectorXd result(count);
  std::size_t b = 0;
  for (Index n = 0; n < count; ++n) {
    const auto x = static_cast<double>(n);
    while (b + 2 < middle.size() && x > middle[b + 1]) ++b;
    double value = level[b];
    if (b + 1 < middle.size() && x > middle[b]) {
      const double share = std::min(1.0, (x - middle[b]) / (middle[b + 1] - middle[b]));
      value += share * (level[b + 1] - level[b]);
    }
    result[n] = std::exp(value);
  }
  return result;
}

// What counts as none: so little of a value itself and of the entry's usual ones that no instrument tells it.
Eigen::VectorXd least_variance(const Eigen::VectorXcd& values, double share) {
  const Eigen::VectorXd squares = values.cwiseAbs2();
  const double usual = median({squares.data(), squares.data() + squares.size()});
  return (share * squares).array() + std::max(kLeastUsual * usual, 1e-300);
}

// Amounts of the shapes (columns, a row a line) that make the squares most probable: sum of ln v + square/v is least.
// Multiplicative steps that never make it larger; amounts stay positive.
Eigen::VectorXd most_probable_variance(const Eigen::VectorXd& squares, const Eigen::MatrixXd& shapes,
                                       const Eigen::VectorXd& least) {
  // Lines that grow apart as frequency does: four numbers need no more, and the lowest count like the highest.
  std::vector<Index> lines;
  for (Index n = 0; n < squares.size(); n += std::max<Index>(1, n / kLinesForAmounts)) lines.push_back(n);
  const Eigen::VectorXd some = squares(lines);
  const Eigen::MatrixXd parts = shapes(lines, Eigen::all);
  const Eigen::VectorXd floor = least(lines);
  Eigen::VectorXd amounts =
      some.mean() / static_cast<double>(parts.cols()) * parts.colwise().mean().cwiseInverse().transpose();
  for (int step = 0; step < kNoiseSteps; ++step) {
    const Eigen::VectorXd inverse = (parts * amounts + floor).cwiseInverse();
    const Eigen::VectorXd pull = some.cwiseProduct(inverse).cwiseMin(kOutlier).cwiseProduct(inverse);
    amounts.array() *= ((parts.transpose() * pull).array() / (parts.transpose() * inverse).array()).sqrt();
  }
  return shapes * amounts + least;
}

// Of one entry: `error` is what stands beside the `fitted` values.
Eigen::VectorXd variance_of(const Eigen::VectorXd& omega, const Eigen::VectorXcd& error, const Eigen::VectorXcd& fitted,
                            const Eigen::VectorXd& least) {
  const Eigen::VectorXd squares = error.cwiseAbs2();
  const Eigen::VectorXd rising = (omega[omega.size() - 1] / omega.array()).square();
  Eigen::MatrixXd shapes(squares.size(), 4);
  shapes << Eigen::VectorXd::Ones(squares.size()), rising, rising.cwiseAbs2(), fitted.cwiseAbs2();
  shapes.col(3) += least;
  const Eigen::VectorXd mixed = most_probable_variance(squares, shapes, least);
  return mixed.cwiseProduct(smooth_mean(squares.cwiseQuotient(mixed), 1e-6)).cwiseMax(least);
}

// An entry of nothing, as computed responses have them across the axes, tells no noise of its own, and taken for exact
// it would outweigh all others: it is as noisy as the quietest of them.
void lend_noise(const FrfLines& lines, std::vector<Eigen::VectorXd>& variances) {
  std::vector<double> power;
  for (const FrfEntry& entry : lines.entries) power.push_back(entry.values.cwiseAbs2().mean());
  const double nothing = kNothing * *std::max_element(power.begin(), power.end());
  Eigen::VectorXd quietest;
  for (std::size_t e = 0; e < power.size(); ++e)
    if (power[e] > nothing) quietest = quietest.size() == 0 ? variances[e] : quietest.cwiseMin(variances[e]).eval();
  for (std::size_t e = 0; e < power.size(); ++e)
    if (power[e] <= nothing && quietest.size() > 0) variances[e] = quietest;
}

}  // namespace

std::vector<Eigen::VectorXd> noise_of_differences(const FrfLines& lines,
                                                  const std::vector<Eigen::VectorXcd>& left_over) {
  std::vector<Eigen::VectorXd> result;
  const Index count = lines.omega.size();
  for (std::size_t e = 0; e < left_over.size(); ++e) {
    const FrfEntry& entry = lines.entries[e];
    const Eigen::VectorXcd& rest = left_over[e];
    Eigen::VectorXcd error(count);
    for (Index n = 0; n < count; ++n) {
      const Index at = std::clamp<Index>(n, 1, count - 2);
      error[n] = (rest[at - 1] - 2.0 * rest[at] + rest[at + 1]) / std::sqrt(6.0);
    }
    result.push_back(variance_of(lines.omega, error, entry.values, least_variance(entry.values, kRoughLeastShare)));
  }
  lend_noise(lines, result);
  return result;
}

std::vector<Eigen::VectorXd> noise_of_remainder(const FrfLines& lines, const std::vector<Eigen::VectorXcd>& left_over) {
  std::vector<Eigen::VectorXd> result;
  for (std::size_t e = 0; e < left_over.size(); ++e) {
    const FrfEntry& entry = lines.entries[e];
    result.push_back(
        variance_of(lines.omega, left_over[e], entry.values - left_over[e], least_variance(entry.values, kLeastShare)));
  }
  lend_noise(lines, result);
  return result;
}

FrfWeights weights_of(const std::vector<Eigen::VectorXd>& variances) {
  FrfWeights weights;
  for (const Eigen::VectorXd& variance : variances) weights.push_back(2.0 * variance.cwiseInverse());
  return weights;
}

double lines_alike(const std::vector<Eigen::VectorXcd>& left_over, const FrfWeights& weights) {
  // Correlation of neighbours over all entries, as far as it stands out of what independent lines would show.
  double alike = 1.0;
  for (Index lag = 1; lag <= kMostAlike; ++lag) {
    double product = 0.0, square = 0.0, values = 0.0;
    for (std::size_t e = 0; e < left_over.size(); ++e) {
      const Eigen::VectorXcd whitened = left_over[e].cwiseProduct(weights[e].cwiseSqrt());
      const Index pairs = whitened.size() - lag;
      if (pairs <= 0) continue;
      product += whitened.head(pairs).dot(whitened.tail(pairs)).real();
      square += whitened.head(pairs).squaredNorm();
      values += static_cast<double>(pairs);
    }
    if (!(square > 0.0)) break;
    const double correlation = product / square;
    if (correlation < 3.0 / std::sqrt(2.0 * values)) break;
    alike += 2.0 * correlation;
  }
  return alike;
}

}  // namespace stillcut
