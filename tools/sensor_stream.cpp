#include "tools/sensor_stream.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>

#include "dsp/hann_line.hpp"

namespace stillcut {
namespace {

constexpr float kNoSample = std::numeric_limits<float>::quiet_NaN();  // lost or not measured
constexpr double kLow_db = -70.0, kStep_db = 0.5;                     // to 57 dB: 0.3 mm/s² to 750 m/s²
constexpr std::int64_t kMarkEvery_ns = 10'000'000'000;                // for the rate
constexpr std::int64_t kLeastForRate_ns = 1'000'000'000;              // arrival times scatter by a millisecond
constexpr std::int64_t kStreamBreaks_ns = 500'000'000;

std::size_t spectrum_length(double seconds, double rate_hz) {
  return std::bit_floor(static_cast<std::size_t>(std::max(64.0, std::numbers::sqrt2 * seconds * rate_hz)));
}

// The mean of the mean of the mean: nothing near a multiple of the thinned rate comes through as something slow.
std::vector<float> thinning_kernel(int thinning) {
  std::vector<double> kernel{1.0};
  for (int pass = 0; pass < 3; ++pass) {
    std::vector<double> wider(kernel.size() + static_cast<std::size_t>(thinning) - 1, 0.0);
    for (std::size_t i = 0; i < kernel.size(); ++i)
      for (std::size_t j = 0; j < static_cast<std::size_t>(thinning); ++j) wider[i + j] += kernel[i] / thinning;
    kernel = wider;
  }
  return {kernel.begin(), kernel.end()};
}

}  // namespace

SensorStream::SensorStream(int sensor, double sample_rate_hz, int teeth)
    : sensor_{sensor},
      teeth_{teeth},
      rate_hz_{sample_rate_hz},
      length_{spectrum_length(kWindow_s, sample_rate_hz)},
      history_(length_, {kNoSample, kNoSample, kNoSample}),
      window_(length_),
      axis_(length_),
      fft_{static_cast<int>(length_)},
      thinning_{std::max(1, static_cast<int>(std::lround(sample_rate_hz / kThinned_hz)))},
      kernel_{thinning_kernel(thinning_)},
      until_thinned_{thinning_} {
  bins_.resize(static_cast<std::size_t>(fft_.bins()));
  for (std::size_t i = 0; i < length_; ++i) window_[i] = hann_weight(i, length_);
  vibration_.sensor = sensor;
  vibration_.rate_hz = sample_rate_hz / thinning_;
  health_.nominal_rate_hz = sample_rate_hz;
}

void SensorStream::add(const SampleBlock& block) {
  const auto stamp_of = [&](int i) {
    return block.stamp_ns - static_cast<std::int64_t>(1e9 * (block.samples - 1 - i) / rate_hz_);
  };
  if (block.frames_lost > 0) {
    health_.lost += block.frames_lost;
    ++health_.gaps;
    const std::int64_t lost = std::int64_t{block.frames_lost} * block.samples;
    const auto bridged = std::min(lost, static_cast<std::int64_t>(length_));
    for (std::int64_t i = 0; i < bridged; ++i) push({kNoSample, kNoSample, kNoSample}, stamp_of(0));
    heard_ += lost - bridged;
  }
  std::uint64_t full = 0;
  for (int axis = 0; axis < kMaxAxes; ++axis) full |= block.full_scale[static_cast<std::size_t>(axis)];
  health_.saturated += std::popcount(full);
  for (int i = 0; i < block.samples; ++i) {
    std::array<float, kMaxAxes> sample{kNoSample, kNoSample, kNoSample};
    bool finite = true;
    for (std::size_t axis = 0; axis < kMaxAxes; ++axis) {
      if ((block.axes_present >> axis & 1U) == 0) continue;
      sample[axis] = block.acceleration[axis][static_cast<std::size_t>(i)];
      finite = finite && std::isfinite(sample[axis]);
    }
    health_.not_finite += finite ? 0 : 1;
    push(sample, stamp_of(i));
  }
  watch_rate(block);
}

void SensorStream::push(const std::array<float, kMaxAxes>& sample, std::int64_t stamp_ns) {
  history_[next_] = sample;
  next_ = (next_ + 1) % length_;
  ++heard_;
  if (--until_thinned_ > 0) return;
  until_thinned_ = thinning_;
  if (static_cast<std::size_t>(heard_) >= kernel_.size()) thin_out(stamp_ns);
}

void SensorStream::thin_out(std::int64_t stamp_ns) {
  const std::size_t taps = kernel_.size();
  std::array<float, kMaxAxes> mean{};
  for (std::size_t i = 0; i < taps; ++i) {
    const auto& sample = history_[(next_ + length_ - 1 - i) % length_];
    for (std::size_t axis = 0; axis < kMaxAxes; ++axis) mean[axis] += kernel_[i] * sample[axis];
  }
  if (vibration_.samples.size() == VibrationReport::kMaxSamples)  // nobody asked: the newest count
    vibration_.samples.erase(vibration_.samples.begin());
  vibration_.samples.push_back(mean);
  // A mean over `taps` samples stands for their middle.
  vibration_.stamp_ns = stamp_ns - static_cast<std::int64_t>(0.5e9 * static_cast<double>(taps - 1) / rate_hz_);
}

VibrationReport SensorStream::take_vibration() {
  VibrationReport taken = vibration_;
  vibration_.samples.clear();
  return taken;
}

SpectrumReport SensorStream::spectrum(double spindle_hz) {
  SpectrumReport report{.stamp_ns = 0, .sensor = sensor_, .teeth = teeth_, .levels = {}};
  if (static_cast<std::size_t>(heard_) < length_ || heard_ == shown_) return report;
  shown_ = heard_;
  const double bin_hz = rate_hz_ / static_cast<double>(length_);
  const auto shown = std::min(bins_.size(), static_cast<std::size_t>(kHighest_hz / bin_hz) + 1);
  const std::size_t pool = (shown + SpectrumReport::kMaxBins - 1) / SpectrumReport::kMaxBins;
  std::vector<float> power((shown + pool - 1) / pool, 0.0F), all(bins_.size(), 0.0F);
  for (std::size_t axis = 0; axis < kMaxAxes; ++axis) {
    double sum = 0.0;
    std::size_t finite = 0;
    for (const auto& sample : history_)
      if (std::isfinite(sample[axis])) sum += sample[axis], ++finite;
    if (finite == 0) continue;
    const auto mean = static_cast<float>(sum / static_cast<double>(finite));  // gravity, and the sensor's offset
    for (std::size_t i = 0; i < length_; ++i) {
      const float x = history_[(next_ + i) % length_][axis];
      axis_[i] = std::isfinite(x) ? (x - mean) * window_[i] : 0.0F;
    }
    fft_.transform(axis_, bins_);
    for (std::size_t k = 0; k < bins_.size(); ++k) all[k] += std::norm(bins_[k]);
  }
  for (std::size_t k = 0; k < shown; ++k) power[k / pool] = std::max(power[k / pool], all[k]);
  report.window_s = static_cast<double>(length_) / rate_hz_;
  report.bin_hz = bin_hz * static_cast<double>(pool);
  report.spindle_hz = spindle_hz;
  report.low_db = kLow_db;
  report.step_db = kStep_db;
  for (const float p : power) {
    const double level = (10.0 * std::log10(static_cast<double>(p) + 1e-20) - kLow_db) / kStep_db;
    report.levels.push_back(static_cast<std::uint8_t>(std::clamp(std::round(level), 0.0, 255.0)));
  }
  return report;
}

// The sensor's clock against the stamps': counts over ten to twenty seconds, from the last time that the stream broke.
void SensorStream::watch_rate(const SampleBlock& block) {
  const Mark now{block.stamp_ns, heard_};
  const double expected_ns = 1e9 * static_cast<double>(now.samples - second_.samples) / rate_hz_;
  const bool broke = std::abs(static_cast<double>(now.stamp_ns - second_.stamp_ns) - expected_ns) > kStreamBreaks_ns;
  if (second_.stamp_ns == 0 || broke) {
    first_ = second_ = now;
    health_.rate_hz = kNaN;
    return;
  }
  if (now.stamp_ns - first_.stamp_ns >= kLeastForRate_ns)
    health_.rate_hz =
        1e9 * static_cast<double>(now.samples - first_.samples) / static_cast<double>(now.stamp_ns - first_.stamp_ns);
  if (now.stamp_ns - second_.stamp_ns >= kMarkEvery_ns) {
    first_ = second_;
    second_ = now;
  }
}

}  // namespace stillcut
