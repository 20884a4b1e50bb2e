#include "dsp/sensor_path.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

namespace stillcut {
namespace {

constexpr double kMeanMemory_s = 0.03;   // gravity, drift and slow feed force leave the level through this
constexpr double kLevelSpan_s = 0.03;    // at least; three revolutions where those are longer
constexpr double kSlowestTurning = 1.0;  // rad/s: below it there is no angle worth following

}  // namespace

SensorPath::SensorPath(const SensorSettings& sensor, const LineWatchSettings& watch)
    : rate_{sensor.sample_rate_hz},
      axes_{std::popcount(static_cast<unsigned>(sensor.axes_present & 7U))},
      filter_{axes_},
      watch_{axes_, sensor.sample_rate_hz, watch} {
  int n = 0;
  for (int a = 0; a < kMaxAxes; ++a) {
    if ((sensor.axes_present >> a & 1U) != 0) axis_[n++] = a;
  }
}

void SensorPath::raise(std::uint32_t doubts) noexcept {
  for (int d = 0; d < kDoubtCount; ++d) {
    if ((doubts >> d & 1U) != 0) doubted_until_[d] = samples_ + watch_.window_length();
  }
}

void SensorPath::skip(std::int64_t samples, double speed) noexcept {
  revolutions_ += speed / (2.0 * std::numbers::pi) * static_cast<double>(samples) / rate_;
  revolutions_ -= std::floor(revolutions_);
  check_.forget_runs();
  if (samples > watch_.window_length() / 4) {
    watch_.clear_window();
    raise(kGap);
    return;
  }
  const std::array<float, kMaxAxes> silence{};
  for (std::int64_t i = 0; i < samples; ++i) watch_.push({silence.data(), static_cast<std::size_t>(axes_)});
}

int SensorPath::process(const SampleBlock& block, int from, double speed) noexcept {
  const bool turning = speed > kSlowestTurning;
  const double revolution_s = turning ? 2.0 * std::numbers::pi / speed : 0.0;
  if (turning) {
    filter_.set_samples_per_revolution(rate_ * revolution_s);
  }
  const auto mean_gain = static_cast<float>(1.0 / (kMeanMemory_s * rate_));
  const double step = std::min(0.5, speed / (2.0 * std::numbers::pi * rate_));  // revolutions a sample
  hop_complete_ = false;
  int i = from;
  while (i < block.samples && !hop_complete_) {
    ++samples_;
    if (const std::uint32_t raised = check_.check(block, i); raised != kNoDoubt) raise(raised);
    std::array<float, kMaxAxes> x{}, residual{};
    for (int a = 0; a < axes_; ++a) x[a] = block.acceleration[axis_[a]][i];
    revolutions_ += step;
    if (revolutions_ >= 1.0) revolutions_ -= 1.0;
    if (turning) {
      filter_.process(revolutions_, {x.data(), static_cast<std::size_t>(axes_)}, residual);
    } else {
      for (int a = 0; a < axes_; ++a) residual[a] = std::isfinite(x[a]) ? x[a] - mean_[a] : 0.0F;
    }
    for (int a = 0; a < axes_; ++a) {
      if (!std::isfinite(x[a])) continue;
      mean_[a] += mean_gain * (x[a] - mean_[a]);
      const float alternating = x[a] - mean_[a];
      hop_power_ += alternating * alternating;
    }
    hop_complete_ = watch_.push({residual.data(), static_cast<std::size_t>(axes_)});
    ++i;
  }
  if (hop_complete_) update_level(revolution_s);
  return i;
}

void SensorPath::update_level(double revolution_s) noexcept {
  newest_power_ = (newest_power_ + 1) % kLevelHops;
  powers_[newest_power_] = hop_power_;
  hop_power_ = 0.0;
  const double hop_s = watch_.hop_length() / rate_;
  const double wanted = std::ceil(std::max(kLevelSpan_s, 3.0 * revolution_s) / hop_s);
  const auto hops = static_cast<std::size_t>(std::min(wanted, double{kLevelHops}));
  double sum = 0.0;
  for (std::size_t h = 0; h < hops; ++h) sum += powers_[(newest_power_ + kLevelHops - h) % kLevelHops];
  level_ = std::sqrt(sum / (static_cast<double>(hops) * watch_.hop_length()));
}

std::uint32_t SensorPath::doubts() const noexcept {
  std::uint32_t all = kNoDoubt;
  for (int d = 0; d < kDoubtCount; ++d) all |= doubted_until_[d] > samples_ ? 1U << d : 0U;
  return all;
}

}  // namespace stillcut
