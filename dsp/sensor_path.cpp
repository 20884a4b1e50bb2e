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
constexpr std::array<float, kMaxSamplesPerBlock> kNothing{};  // on the lanes of axes that are not there
constexpr double kSlowestTurning = 1.0;                       // rad/s: below it there is no angle worth following

}  // namespace

SensorPath::SensorPath(const SensorSettings& sensor, const LineWatchSettings& watch)
    : rate_{sensor.sample_rate_hz},
      axes_present_{static_cast<std::uint8_t>(sensor.axes_present & 7U)},
      axes_{std::popcount(static_cast<unsigned>(axes_present_))},
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
  const Lanes silence;
  for (std::int64_t i = 0; i < samples; ++i) {
    watch_.push({&silence, 1});
    if (slow_.push({&slow_sample_, 1})) slow_stepped_ = true;
  }
}

void SensorPath::look_for_doubts(const SampleBlock& block, int from, std::span<const Lanes> x) noexcept {
  const int n = static_cast<int>(x.size());
  if (block.axes_present == axes_present_ && check_.beyond_doubt(block, x)) {
    samples_ += n;
    return;
  }
  for (int i = from; i < from + n; ++i) {
    ++samples_;
    if (const std::uint32_t raised = check_.check(block, i); raised != kNoDoubt) raise(raised);
  }
}

void SensorPath::turn(double step, std::span<double> angles) noexcept {
  double angle = revolutions_;
  for (double& each : angles) {
    angle += step;
    if (angle >= 1.0) angle -= 1.0;
    each = angle;
  }
  revolutions_ = angle;
}

void SensorPath::follow_mean(std::span<const Lanes> x, std::span<Lanes> alternating) noexcept {
  const auto gain = static_cast<float>(1.0 / (kMeanMemory_s * rate_));
  const Lanes zero;
  Lanes mean = mean_, power;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const Lanes off = where_finite(x[i], x[i] - mean, zero);
    alternating[i] = off;
    mean += gain * off;
    const Lanes rest = where_finite(x[i], x[i] - mean, zero);
    power += rest * rest;
  }
  mean_ = mean;
  hop_power_ += sum(power);
}

// A stage at a time over all samples of the block that belong to one hop.
int SensorPath::process(const SampleBlock& block, int from, double speed) noexcept {
  probe_(Stage::filter);
  const bool turning = speed > kSlowestTurning;
  const double revolution_s = turning ? 2.0 * std::numbers::pi / speed : 0.0;
  if (turning && filter_.set_samples_per_revolution(rate_ * revolution_s)) table_changed_ = true;
  hop_complete_ = false;
  const int to = std::min<int>(block.samples, from + watch_.to_hop());
  if (to <= from) return from;
  const auto n = static_cast<std::size_t>(to - from);
  const std::span angles{angles_.data(), n};
  const std::span x{x_.data(), n}, residual{residual_.data(), n}, slow{without_orders_.data(), n};
  std::array<const float*, kMaxAxes> column{};
  for (int a = 0; a < kMaxAxes; ++a) column[a] = a < axes_ ? &block.acceleration[axis_[a]][from] : kNothing.data();
  for (std::size_t i = 0; i < n; ++i) x[i] = {column[0][i], column[1][i], column[2][i], 0.0F};
  look_for_doubts(block, from, x);
  turn(std::min(0.5, speed / (2.0 * std::numbers::pi * rate_)), angles);
  follow_mean(x, residual);
  if (turning) {
    filter_.process(angles, x, residual, slow);
  } else {
    std::copy(x.begin(), x.end(), slow.begin());
  }
  for (std::size_t i = 0; i < n; ++i) slow[i] = slow_sample_ = where_finite(x[i], slow[i], slow_sample_);
  if (slow_.push(slow)) slow_stepped_ = true;
  Lanes power;
  for (std::size_t i = 0; i < n; ++i) power += residual[i] * residual[i];
  hop_residual_ += sum(power);
  probe_(Stage::transform);
  hop_complete_ = watch_.push(residual);
  probe_(Stage::decide);
  if (hop_complete_) update_level(revolution_s);
  return to;
}

void SensorPath::update_level(double revolution_s) noexcept {
  newest_power_ = (newest_power_ + 1) % kLevelHops;
  powers_[newest_power_] = std::exchange(hop_power_, 0.0);
  residual_powers_[newest_power_] = std::exchange(hop_residual_, 0.0);
  const double hop_s = watch_.hop_length() / rate_;
  const double wanted = std::ceil(std::max(kLevelSpan_s, 3.0 * revolution_s) / hop_s);
  const auto hops = static_cast<std::size_t>(std::min(wanted, double{kLevelHops}));
  double whole = 0.0, residual = 0.0;
  for (std::size_t h = 0; h < hops; ++h) {
    const std::size_t at = (newest_power_ + kLevelHops - h) % kLevelHops;
    whole += powers_[at];
    residual += residual_powers_[at];
  }
  update_changes(revolution_s);
  level_ = std::sqrt(whole / (static_cast<double>(hops) * watch_.hop_length()));
  residual_level_ = std::sqrt(residual / (static_cast<double>(hops) * watch_.hop_length()));
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
    if (most > fall_ * sum && sum > 0.0) fall_ = most / sum;
    if (sum > rise_ * least && least > 0.0) rise_ = sum / least;
  }
}

std::uint32_t SensorPath::doubts() const noexcept {
  std::uint32_t all = kNoDoubt;
  for (int d = 0; d < kDoubtCount; ++d) all |= doubted_until_[d] > samples_ ? 1U << d : 0U;
  return all;
}

}  // namespace stillcut
