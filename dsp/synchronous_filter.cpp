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

}  // namespace

SynchronousFilter::SynchronousFilter(int axes)
    : axes_{axes}, table_(static_cast<std::size_t>(kMaxKnots) * axes, 0.0F) {}

bool SynchronousFilter::set_samples_per_revolution(double samples_per_revolution) noexcept {
  samples_per_revolution_ = samples_per_revolution;
  const auto wanted = static_cast<unsigned>(std::clamp(0.9 * samples_per_revolution, 1.0, double{kMaxKnots}));
  const int knots = std::max(kMinKnots, static_cast<int>(std::bit_ceil(wanted)));
  // Hysteresis: near a power of two the number of knots must not flip with every speed message.
  const bool close_enough =
      knots_ > 0 && 0.8 * samples_per_revolution <= knots_ && knots_ <= 2.2 * samples_per_revolution;
  if (close_enough || knots == knots_) return false;
  knots_ = knots;
  std::fill(table_.begin(), table_.end(), 0.0F);
  usual_.fill(0.0F);
  mean_.fill(0.0);
  restart();
  until_gain_ = 0;
  return true;
}

void SynchronousFilter::forget() noexcept {
  for (std::size_t i = 0; i < table_.size(); ++i)
    table_[i] = static_cast<float>(mean_[i % static_cast<std::size_t>(axes_)]);
  usual_.fill(0.0F);
  restart();
}

void SynchronousFilter::process(double angle, std::span<const float> x, std::span<float> residual) noexcept {
  if (knots_ == 0) {
    for (int a = 0; a < axes_; ++a) residual[a] = std::isfinite(x[a]) ? x[a] : 0.0F;
    return;
  }
  if (--until_gain_ < 0) {
    // The gain that forgets with the wanted memory; while little is learned the memory is what has been seen so far.
    const double memory = std::clamp(learned_revolutions_ + 0.5, 1.0, memory_);
    gain_ =
        static_cast<float>((1.0 - std::exp(-1.0 / memory)) * knots_ / std::max(samples_per_revolution_, 0.9 * knots_));
    usual_gain_ = static_cast<float>(1.0 / (kUsualMemory * samples_per_revolution_));
    until_gain_ = std::max(8, static_cast<int>(samples_per_revolution_ / 4.0));
    learned_revolutions_ += until_gain_ / samples_per_revolution_;
  }
  const double position = angle * knots_;
  const int k = static_cast<int>(position);
  const auto f = static_cast<float>(position - k);
  const float g = 1.0F - f;
  const std::array<float, 4> b = {g * g * g / 6.0F, (3.0F * f * f * f - 6.0F * f * f + 4.0F) / 6.0F,
                                  (3.0F * g * g * g - 6.0F * g * g + 4.0F) / 6.0F, f * f * f / 6.0F};
  const int mask = knots_ - 1;
  std::array<float*, 4> c{};
  for (int i = 0; i < 4; ++i) c[i] = table_.data() + static_cast<std::ptrdiff_t>((k + i) & mask) * axes_;
  for (int a = 0; a < axes_; ++a) {
    if (!std::isfinite(x[a])) {
      residual[a] = 0.0F;
      continue;
    }
    const float e = x[a] - (b[0] * c[0][a] + b[1] * c[1][a] + b[2] * c[2][a] + b[3] * c[3][a]);
    const float limit = kClip * kClip * usual_[a];
    const bool clipped = e * e > limit && learned_revolutions_ > kRevolutionsUnclipped;
    usual_[a] += usual_gain_ * ((clipped ? limit : e * e) - usual_[a]);
    const float step = gain_ * (clipped ? std::copysign(std::sqrt(limit), e) : e);
    for (int i = 0; i < 4; ++i) c[i][a] += step * b[i];
    mean_[a] += static_cast<double>(step) / knots_;
    residual[a] = e;
  }
}

double SynchronousFilter::level() const noexcept {
  if (knots_ == 0) return 0.0;
  double power = 0.0;
  const auto axes = static_cast<std::size_t>(axes_), mask = static_cast<std::size_t>(knots_) - 1;
  for (std::size_t k = 0; k <= mask; ++k) {
    const float* const before = table_.data() + ((k + mask) & mask) * axes;
    const float* const at = table_.data() + k * axes;
    const float* const after = table_.data() + ((k + 1) & mask) * axes;
    for (std::size_t a = 0; a < axes; ++a) {
      const double smooth = 0.25 * (before[a] + 2.0F * at[a] + after[a]) - mean_[a];
      power += smooth * smooth;
    }
  }
  return std::sqrt(power / knots_);
}

double SynchronousFilter::displacement(double speed) const noexcept {
  if (knots_ == 0 || !(speed > 0.0)) return 0.0;
  const double step_s = 2.0 * std::numbers::pi / (speed * knots_);
  double power = 0.0;
  for (int a = 0; a < axes_; ++a) {
    const auto at = [&](int k) { return static_cast<double>(table_[static_cast<std::size_t>(k) * axes_ + a]); };
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

}  // namespace stillcut
