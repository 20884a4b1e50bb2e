#include "models/leading_multiplier.hpp"

#include <algorithm>
#include <cmath>

#include "models/hessenberg.hpp"
#include "models/multiversion.hpp"

namespace stillcut {
namespace {

constexpr int kMostVectors = 96;
constexpr int kRows = kMostVectors + 1;

// Four sums side by side: the same order on every processor, and room for the processor to work in parallel.
STILLCUT_MULTIVERSION double dot(const double* a, const double* b, int size) {
  double sum[4] = {0.0, 0.0, 0.0, 0.0};
  int i = 0;
  for (; i + 4 <= size; i += 4) {
    for (int lane = 0; lane < 4; ++lane) sum[lane] += a[i + lane] * b[i + lane];
  }
  for (; i < size; ++i) sum[0] += a[i] * b[i];
  return (sum[0] + sum[1]) + (sum[2] + sum[3]);
}

STILLCUT_MULTIVERSION void subtract(double factor, const double* from, int size, double* to) {
  for (int i = 0; i < size; ++i) to[i] -= factor * from[i];
}

}  // namespace

LeadingMultiplier Arnoldi::leading(const LinearMap& map, int least, double tolerance) {
  size_ = map.size();
  const auto size = static_cast<std::size_t>(size_);
  const int most = std::min(size_, kMostVectors);
  least = std::min(least, most);
  const auto room = size * (static_cast<std::size_t>(most) + 1);
  if (basis_.size() < room) basis_.resize(room);
  if (scratch_.size() < size) scratch_.resize(size);
  hessenberg_.resize(static_cast<std::size_t>(kRows * kMostVectors));
  const auto vector = [&](int k) { return basis_.data() + static_cast<std::size_t>(k) * size; };

  // A start without symmetry, through the map once: what the map cannot reach is gone.
  for (std::size_t i = 0; i < size; ++i) {
    const double turn = 0.6180339887498949 * static_cast<double>(i + 1);
    scratch_[i] = 0.5 + turn - std::floor(turn);
  }
  map.apply(scratch_.data(), vector(0));
  double length = std::sqrt(dot(vector(0), vector(0), size_));
  order_ = 0;
  if (!(length > 0.0)) return {0.0, 0.0};
  for (std::size_t i = 0; i < size; ++i) basis_[i] /= length;

  constexpr double kNothingNew = 1e-14;  // of the vector before orthogonalisation: the space is closed
  constexpr double kCondition = 0.1;     // a residual moves the eigenvalue by more than itself
  constexpr int kStep = 2;
  int next_look = std::clamp(last_order_ - 1, least, most);
  LeadingMultiplier result;
  for (int k = 0; k < most; ++k) {
    double* fresh = vector(k + 1);
    double* column = hessenberg_.data() + k * kRows;
    map.apply(vector(k), fresh);
    const double whole = std::sqrt(dot(fresh, fresh, size_));
    for (int j = 0; j <= k; ++j) {
      column[j] = dot(vector(j), fresh, size_);
      subtract(column[j], vector(j), size_, fresh);
    }
    length = std::sqrt(dot(fresh, fresh, size_));
    column[k + 1] = length;
    order_ = k + 1;
    const bool closed = length <= kNothingNew * whole || order_ == most;
    if (order_ >= next_look || closed) {
      result.value = value_ = largest_ritz_value(order_);
      find_ritz_vector();
      result.residual = closed ? 0.0 : length * std::abs(ritz_vector_.back());
      if (result.residual <= kCondition * tolerance * std::max(1.0, std::abs(value_))) break;
      next_look = order_ + kStep;
    }
    for (std::size_t i = 0; i < size; ++i) fresh[i] /= length;
  }
  last_order_ = order_;
  return result;
}

// The unit eigenvector of the Hessenberg matrix, from its last component upward: row j + 1 gives component j.
void Arnoldi::find_ritz_vector() {
  constexpr double kLarge = 1e150;  // keeps long runs of small subdiagonals in range
  const auto order = static_cast<std::size_t>(order_);
  ritz_vector_.assign(order, 1.0);
  double square = 1.0;
  for (std::size_t j = order - 1; j-- > 0;) {
    const auto entry = [&](std::size_t column) { return hessenberg_[column * kRows + j + 1]; };
    std::complex<double> sum = value_ * ritz_vector_[j + 1];
    for (std::size_t i = j + 1; i < order; ++i) sum -= entry(i) * ritz_vector_[i];
    ritz_vector_[j] = sum / entry(j);
    square += std::norm(ritz_vector_[j]);
    if (square > kLarge) {
      for (std::size_t i = j; i < order; ++i) ritz_vector_[i] /= std::sqrt(square);
      square = 1.0;
    }
  }
  for (std::complex<double>& component : ritz_vector_) component /= std::sqrt(square);
}

std::complex<double> Arnoldi::largest_ritz_value(int order) {
  if (scratch_.size() < static_cast<std::size_t>(order * order))
    scratch_.resize(static_cast<std::size_t>(order * order));
  for (int j = 0; j < order; ++j) {
    for (int i = 0; i < order; ++i) {
      scratch_[static_cast<std::size_t>(j * order + i)] =
          i <= j + 1 ? hessenberg_[static_cast<std::size_t>(j * kRows + i)] : 0.0;
    }
  }
  return largest_eigenvalue_of_hessenberg(scratch_.data(), order);
}

std::vector<std::complex<double>> Arnoldi::eigenvector(int count) const {
  std::vector<std::complex<double>> vector(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    for (int k = 0; k < order_; ++k) {
      vector[static_cast<std::size_t>(i)] +=
          basis_[static_cast<std::size_t>(k * size_ + i)] * ritz_vector_[static_cast<std::size_t>(k)];
    }
  }
  return vector;
}

}  // namespace stillcut
