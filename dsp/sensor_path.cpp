#include "dsp/sensor_path.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

#include "dsp/numbers.hpp"

namespace stillcut {
namespace {

constexpr double kMeanMemory_s = 0.03;  // gravity, drift and slow feed force leave the level through this
constexpr double kLevelSpan_s = 0.03;   // at least; three revolutions where those are longer
constexpr double kFallSpan_s = 0.25;
constexpr double kSlowestTurning = 1.0;  // rad/s: below it there is no angle worth following

}  // namespace

SensorPath::SensorPath(const SensorSettings& sensor, const LineWatchSettings& watch)
    : rate_{sensor.sample_rate_hz},
      axes_{std::popcount(static_cast<unsigned>(sensor.axes_present & 7U))},
      filter_{axes_},
      watch_{axes_, sensor.sample_rate_hz, watch},
      slow_{axes_, sensor.sample_rate_hz} {
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
    slow_.clear();
    raise(kGap);
    return;
  }
  const std::array<float, kMaxAxes> silence{};
  for (std::int64_t i = 0; i < samples; ++i) {
    watch_.push({silence.data(), static_cast<std::size_t>(axes_)});
    if (slow_.push({slow_sample_.data(), static_cast<std::size_t>(axes_)})) slow_stepped_ = true;
  }
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
    for (int a = 0; a < axes_; ++a) {
      if (std::isfinite(x[a])) slow_sample_[a] = turning ? residual[a] + filter_.mean(a) : x[a];
    }
    if (slow_.push({slow_sample_.data(), static_cast<std::size_t>(axes_)})) slow_stepped_ = true;
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
  double whole = 0.0;
  for (std::size_t h = 0; h < hops; ++h) whole += powers_[(newest_power_ + kLevelHops - h) % kLevelHops];
  update_changes(revolution_s);
  level_ = std::sqrt(whole / (static_cast<double>(hops) * watch_.hop_length()));
  synchronous_level_ = revolution_s > 0.0 ? filter_.level() : level_;
}

void SensorPath::update_changes(double revolution_s) noexcept {
  const double hop_s = watch_.hop_length() / rate_;
  const auto span = std::min(kLevelHops, static_cast<std::size_t>(kFallSpan_s / hop_s));
  const auto turn = std::min(span / 2, static_cast<std::size_t>(std::ceil(revolution_s / hop_s)) + 1);
  const auto before = [&](std::size_t hops) { return powers_[(newest_power_ + kLevelHops - hops) % kLevelHops]; };
  // From the oldest on: the most and the least that a revolution has held so far, beside what each holds.
  double sum = 0.0, most = 0.0, least = kInfinity;
  fall_ = rise_ = 1.0;
  for (std::size_t h = span; h-- > 0;) {
    sum += before(h);
    if (h + turn < span) sum -= before(h + turn);
    if (h + turn > span) continue;
    most = std::max(most, sum);
    least = std::min(least, sum);
    if (sum > 0.0) fall_ = std::max(fall_, most / sum);
    if (least > 0.0) rise_ = std::max(rise_, sum / least);
  }
}

std::uint32_t SensorPath::doubts() const noexcept {
  std::uint32_t all = kNoDoubt;
  for (int d = 0; d < kDoubtCount; ++d) all |= doubted_until_[d] > samples_ ? 1U << d : 0U;
  return all;
}

}  // namespace stillcut
