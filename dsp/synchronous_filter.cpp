#include "dsp/synchronous_filter.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

namespace stillcut {
namespace {

constexpr double kRevolutionsUnclipped = 4.0;
constexpr double kUsualMemory = 2.0;  // revolutions
constexpr float kClip = 3.0F;         // times the usual residual
constexpr float kSixth = 1.0F / 6.0F;

Lanes lanes_of(const std::array<double, kMaxAxes>& axes) noexcept {
  return {static_cast<float>(axes[0]), static_cast<float>(axes[1]), static_cast<float>(axes[2]), 0.0F};
}

}  // namespace

SynchronousFilter::SynchronousFilter(int axes) : axes_{axes}, table_(kMaxKnots) {}

bool SynchronousFilter::set_samples_per_revolution(double samples_per_revolution) noexcept {
  samples_per_revolution_ = samples_per_revolution;
  const auto wanted = static_cast<unsigned>(std::clamp(0.9 * samples_per_revolution, 1.0, double{kMaxKnots}));
  const int knots = std::max(kMinKnots, static_cast<int>(std::bit_ceil(wanted)));
  // Hysteresis: near a power of two the number of knots must not flip with every speed message.
  const bool close_enough =
      knots_ > 0 && 0.8 * samples_per_revolution <= knots_ && knots_ <= 2.2 * samples_per_revolution;
  if (close_enough || knots == knots_) return false;
  knots_ = knots;
  mean_.fill(0.0);
  forget();
  until_gain_ = 0;
  return true;
}

void SynchronousFilter::forget() noexcept {
  std::fill(table_.begin(), table_.end(), lanes_of(mean_));
  usual_ = Lanes{};
  restart();
}

double SynchronousFilter::memory() const noexcept { return std::clamp(learned_revolutions_ + 0.5, 1.0, memory_); }

void SynchronousFilter::update_gain() noexcept {
  // The gain that forgets with the wanted memory; while little is learned the memory is what has been seen so far.
  gain_ =
      static_cast<float>((1.0 - std::exp(-1.0 / memory())) * knots_ / std::max(samples_per_revolution_, 0.9 * knots_));
  usual_gain_ = static_cast<float>(1.0 / (kUsualMemory * samples_per_revolution_));
  const int samples = std::max(8, static_cast<int>(samples_per_revolution_ / 4.0));
  learned_revolutions_ += samples / samples_per_revolution_;
  until_gain_ = samples + 1;
}

void SynchronousFilter::process(std::span<const double> angles, std::span<const Lanes> x, std::span<Lanes> residual,
                                std::span<Lanes> without_orders) noexcept {
  if (knots_ == 0) {
    for (std::size_t i = 0; i < x.size(); ++i) residual[i] = without_orders[i] = where_finite(x[i], x[i], Lanes{});
    return;
  }
  for (std::size_t done = 0; done < x.size();) {
    if (until_gain_ == 0) update_gain();
    const std::size_t n = std::min({x.size() - done, static_cast<std::size_t>(until_gain_), kStretch});
    learn(angles.subspan(done, n), x.data() + done, residual.data() + done, without_orders.data() + done);
    until_gain_ -= static_cast<int>(n);
    done += n;
  }
}

void SynchronousFilter::process(double angle, std::span<const float> x, std::span<float> residual) noexcept {
  Lanes in, out, rest;
  for (int a = 0; a < axes_; ++a) in.set(a, x[a]);
  process({&angle, 1}, {&in, 1}, {&out, 1}, {&rest, 1});
  for (int a = 0; a < axes_; ++a) residual[a] = out[a];
}

void SynchronousFilter::learn(std::span<const double> angles, const Lanes* x, Lanes* residual,
                              Lanes* without_orders) noexcept {
  // The splines' weights first, for they do not depend on what is learned on the way.
  const int knots = knots_;
  for (std::size_t i = 0; i < angles.size(); ++i) {
    const double position = angles[i] * knots;
    const int k = static_cast<int>(position);
    const auto f = static_cast<float>(position - k);
    const float g = 1.0F - f;
    knot_[i] = k;
    weights_[0][i] = kSixth * (g * g * g);
    weights_[1][i] = kSixth * (3.0F * f * f * f - 6.0F * f * f + 4.0F);
    weights_[2][i] = kSixth * (3.0F * g * g * g - 6.0F * g * g + 4.0F);
    weights_[3][i] = kSixth * (f * f * f);
  }
  const int mask = knots_ - 1;
  const bool clips = learned_revolutions_ > kRevolutionsUnclipped;
  const Lanes zero, mean_before = lanes_of(mean_);
  const float per_knot = 1.0F / static_cast<float>(knots_);
  Lanes usual = usual_, learned;
  for (std::size_t i = 0; i < angles.size(); ++i) {
    const int k = knot_[i];
    const float b0 = weights_[0][i], b1 = weights_[1][i], b2 = weights_[2][i], b3 = weights_[3][i];
    Lanes &c0 = table_[k & mask], &c1 = table_[(k + 1) & mask], &c2 = table_[(k + 2) & mask],
          &c3 = table_[(k + 3) & mask];
    const Lanes e = where_finite(x[i], x[i] - (b0 * c0 + b1 * c1 + b2 * c2 + b3 * c3), zero);
    const Lanes limit = kClip * sqrt(usual);
    const Lanes seen = clips ? max(zero - limit, min(e, limit)) : e;
    usual += where_finite(x[i], usual_gain_ * (seen * seen - usual), zero);
    const Lanes step = gain_ * seen;
    c0 += b0 * step;
    c1 += b1 * step;
    c2 += b2 * step;
    c3 += b3 * step;
    learned += step;
    residual[i] = e;
    without_orders[i] = e + mean_before + per_knot * learned;
  }
  usual_ = usual;
  for (int a = 0; a < axes_; ++a) mean_[a] += static_cast<double>(learned[a]) / knots_;
}

double SynchronousFilter::level() const noexcept {
  if (knots_ == 0) return 0.0;
  const auto last = static_cast<std::size_t>(knots_) - 1;
  const Lanes mean_now = lanes_of(mean_);
  Lanes power;
  for (std::size_t k = 0; k <= last; ++k) {
    const Lanes smooth = 0.25F * (table_[(k + last) & last] + 2.0F * table_[k] + table_[(k + 1) & last]) - mean_now;
    power += smooth * smooth;
  }
  return std::sqrt(static_cast<double>(sum(power)) / knots_);
}

double SynchronousFilter::displacement(double speed) const noexcept {
  if (knots_ == 0 || !(speed > 0.0)) return 0.0;
  const double step_s = 2.0 * std::numbers::pi / (speed * knots_);
  double power = 0.0;
  for (int a = 0; a < axes_; ++a) {
    const auto at = [&](int k) { return static_cast<double>(table_[static_cast<std::size_t>(k)][a]); };
    double mean_acceleration = 0.0, velocity = 0.0, mean_velocity = 0.0;
    for (int k = 0; k < knots_; ++k) mean_acceleration += at(k) / knots_;
    for (int k = 0; k < knots_; ++k) {
      velocity += (at(k) - mean_acceleration) * step_s;
      mean_velocity += velocity / knots_;
    }
    double x = 0.0, sum = 0.0, square = 0.0;
    velocity = 0.0;
    for (int k = 0; k < knots_; ++k) {
      velocity += (at(k) - mean_acceleration) * step_s;
      x += (velocity - mean_velocity) * step_s;
      sum += x / knots_;
      square += x * x / knots_;
    }
    power += std::max(0.0, square - sum * sum);
  }
  return std::sqrt(power);
}

// The Fourier coefficient of the knots, times what a cubic B-spline makes of it. The spline of c_k stands over knot k
// - 1.
std::complex<float> SynchronousFilter::content(int order, int axis) const noexcept {
  if (2 * order >= knots_) return {};
  const double radians = 2.0 * std::numbers::pi * order / knots_, half = 0.5 * radians;
  const std::complex<double> turn = std::polar(1.0, -radians);
  std::complex<double> phasor = std::conj(turn), sum;
  for (int k = 0; k < knots_; ++k, phasor *= turn)
    sum += static_cast<double>(table_[static_cast<std::size_t>(k)][axis]) * phasor;
  const double sinc = order != 0 ? std::sin(half) / half : 1.0;
  return std::complex<float>{sum * (2.0 / knots_ * sinc * sinc * sinc * sinc)};
}

}  // namespace stillcut
