#include "models/modal_response.hpp"

#include <array>
#include <atomic>
#include <cmath>
#include <memory>
#include <mutex>
#include <span>
#include <stdexcept>

#include "models/multiversion.hpp"

namespace stillcut {
namespace {

// e^{(re + i im) t} at many t in [0, 1], by a short Taylor series and repeated squaring: exact to a few units in the
// last place times the number of squarings' power, and many times faster than a call of sine and cosine for each.
STILLCUT_MULTIVERSION void turning_decays(const double* times, int count, double re, double im, double* cosine,
                                          double* sine) {
  constexpr double kSmall = 0.8;  // 15 terms reach 1e-15 of 1 here
  constexpr int kTerms = 15;
  int squarings = 0;
  for (double size = std::abs(re) + std::abs(im); size > kSmall; size *= 0.5) ++squarings;
  const double scale = std::ldexp(1.0, -squarings), small_re = re * scale, small_im = im * scale;
  for (int i = 0; i < count; ++i) {
    const double a = small_re * times[i], b = small_im * times[i];
    double c = 1.0, s = 0.0;
    for (int k = kTerms; k >= 1; --k) {
      const double share = 1.0 / k;
      const double next = 1.0 + (c * a - s * b) * share;
      s = (c * b + s * a) * share;
      c = next;
    }
    cosine[i] = c;
    sine[i] = s;
  }
  for (int square = 0; square < squarings; ++square) {
    for (int i = 0; i < count; ++i) {
      const double c = cosine[i], s = sine[i];
      cosine[i] = c * c - s * s;
      sine[i] = 2.0 * c * s;
    }
  }
}

// answer[i][j] = sum_k kernel[i][k] weights[i][k][j], `rows` rows i of n x n weights each.
STILLCUT_MULTIVERSION void weighted(const double* kernel, const double* weights, int rows, int n, double* answer) {
  for (int i = 0; i < rows; ++i) {
    double* row = answer + i * n;
    for (int j = 0; j < n; ++j) row[j] = 0.0;
    for (int k = 0; k < n; ++k) {
      const double factor = kernel[i * n + k];
      const double* weight = weights + (i * n + k) * n;
      for (int j = 0; j < n; ++j) row[j] += factor * weight[j];
    }
  }
}

constexpr std::size_t kMostNodes = 128;

}  // namespace

Oscillator::Oscillator(const Mode& mode)
    : frequency(mode.natural_frequency),
      decay(mode.damping_ratio * mode.natural_frequency),
      damped_frequency(mode.natural_frequency * std::sqrt(1.0 - mode.damping_ratio * mode.damping_ratio)),
      gain(mode.natural_frequency * mode.natural_frequency / mode.stiffness),
      direction(Eigen::Vector3d(mode.direction.data()).normalized()) {}

Eigen::Matrix2d Oscillator::transition(double time) const {
  const double e = std::exp(-decay * time), c = e * std::cos(damped_frequency * time);
  const double s = e * std::sin(damped_frequency * time) / damped_frequency;
  return Eigen::Matrix2d{{c + decay * s, frequency * s}, {-frequency * s, c - decay * s}};
}

Eigen::Vector2d Oscillator::impulse(double time) const { return transition(time).col(1) * (gain / frequency); }

ForcedStretch::ForcedStretch(int nodes) : rule_(gauss_legendre(nodes)) {
  // A force's share in the answer at time t is its integral over [0, t]: the rule squeezed into [0, t]. The point t x_k
  // lies t (1 - x_k) before t, and 1 - x_k is the node opposite: decays are needed at the products of two nodes only.
  const auto& x = rule_.nodes;
  for (int i = 0; i < nodes; ++i) {
    for (int k = 0; k <= i; ++k) times_.push_back(x[i] * x[k]);
  }
  times_.insert(times_.end(), x.begin(), x.end());
  for (int i = 0; i <= nodes; ++i) {
    const double until = i < nodes ? x[i] : 1.0;
    const Eigen::MatrixXd basis = lagrange_basis(x, until * x);
    for (int k = nodes - 1; k >= 0; --k) {
      for (int j = 0; j < nodes; ++j) weights_.push_back(until * rule_.weights[k] * basis(k, j));
    }
  }
}

void ForcedStretch::respond(const Oscillator& mode, double duration, bool with_rates, ModalResponse& response) const {
  const int n = size(), count = static_cast<int>(times_.size()), ends = count - n;
  constexpr std::size_t kMostTimes = kMostNodes * (kMostNodes + 3) / 2;
  thread_local std::array<double, kMostTimes> cosine, sine;
  thread_local std::vector<double> kernel;
  turning_decays(times_.data(), count, -mode.decay * duration, mode.damped_frequency * duration, cosine.data(),
                 sine.data());

  // Impulse responses of q and of q'/w: scaled combinations of the decays.
  const double lean = mode.decay / mode.damped_frequency;
  const double to_q = duration * mode.gain / mode.damped_frequency, to_rate = duration * mode.gain / mode.frequency;
  const auto unfold = [&](auto&& impulse) {  // at x_i x_k for every i, k
    kernel.resize(static_cast<std::size_t>(n) * static_cast<std::size_t>(n));
    std::size_t place = 0;
    for (std::size_t i = 0; i < static_cast<std::size_t>(n); ++i) {
      for (std::size_t k = 0; k <= i; ++k, ++place) {
        kernel[i * static_cast<std::size_t>(n) + k] = kernel[k * static_cast<std::size_t>(n) + i] = impulse(place);
      }
    }
  };
  const auto q = [&](std::size_t place) { return to_q * sine[place]; };
  const auto rate = [&](std::size_t place) { return to_rate * (cosine[place] - lean * sine[place]); };

  response.forced.resize(n, n);
  unfold(q);
  weighted(kernel.data(), weights_.data(), n, n, response.forced.data());
  if (with_rates) {
    response.forced_rate.resize(n, n);
    unfold(rate);
    weighted(kernel.data(), weights_.data(), n, n, response.forced_rate.data());
  }
  const double* to_end = weights_.data() + n * n * n;
  response.forced_end.resize(2, n);
  response.free.resize(2, n);
  if (with_rates) response.free_rate.resize(2, n);
  std::array<double, 2 * kMostNodes> end_kernel{};
  const double stretch_of = mode.frequency / mode.damped_frequency;
  for (int i = 0; i < n; ++i) {
    const auto place = static_cast<std::size_t>(ends + i);
    end_kernel[static_cast<std::size_t>(i)] = q(place);
    end_kernel[kMostNodes + static_cast<std::size_t>(i)] = rate(place);
    response.free(0, i) = cosine[place] + lean * sine[place];
    response.free(1, i) = stretch_of * sine[place];
    if (with_rates) {
      response.free_rate(0, i) = -stretch_of * sine[place];
      response.free_rate(1, i) = cosine[place] - lean * sine[place];
    }
  }
  weighted(end_kernel.data(), to_end, 1, n, response.forced_end.data());
  weighted(end_kernel.data() + kMostNodes, to_end, 1, n, response.forced_end.data() + n);
  response.free_end = mode.transition(duration);
}

Eigen::RowVectorXd ForcedStretch::displacement_at(const Oscillator& mode, double duration, double time) const {
  const auto& x = rule_.nodes;
  const Eigen::MatrixXd basis = lagrange_basis(x, time / duration * x);
  Eigen::RowVectorXd result = Eigen::RowVectorXd::Zero(2 + size());
  result.head<2>() = mode.transition(time).row(0);
  for (Eigen::Index k = 0; k < x.size(); ++k) {
    result.tail(size()) += time * rule_.weights[k] * mode.impulse(time * (1.0 - x[k]))[0] * basis.row(k);
  }
  return result;
}

const ForcedStretch& forced_stretch(int nodes) {
  static std::array<std::atomic<const ForcedStretch*>, kMostNodes + 1> made{};
  static std::array<std::unique_ptr<const ForcedStretch>, kMostNodes + 1> owned;
  static std::mutex mutex;
  const auto index = static_cast<std::size_t>(nodes);
  if (nodes < 1 || index > kMostNodes) throw std::invalid_argument("a stretch has 1 to 128 nodes");
  if (const ForcedStretch* table = made[index].load(std::memory_order_acquire)) return *table;
  const std::lock_guard lock(mutex);
  if (!owned[index]) {
    owned[index] = std::make_unique<const ForcedStretch>(nodes);
    made[index].store(owned[index].get(), std::memory_order_release);  // pairs with the load above
  }
  return *owned[index];
}

}  // namespace stillcut
