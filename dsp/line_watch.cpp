#include "dsp/line_watch.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "dsp/tone.hpp"

namespace stillcut {
namespace {

constexpr double kNearMode = 0.15;       // of the mode's frequency: where its chatter may stand
constexpr float kTiniestFloor = 1e-12F;  // (m/s^2)^2: a sensor at perfect rest must not divide by nothing

bool smooth(int n) noexcept {
  for (const int factor : {2, 3, 5}) {
    while (n % factor == 0) n /= factor;
  }
  return n == 1;
}

}  // namespace

int window_length(double sample_rate_hz, double duration_s) noexcept {
  int eighth = std::max(8, static_cast<int>(std::ceil(sample_rate_hz * duration_s / 8.0 - 1e-9)));
  while (!smooth(eighth)) ++eighth;
  return 8 * eighth;
}

bool near_a_mode(std::span<const ExpectedMode> modes, double frequency_hz, double share) noexcept {
  return std::any_of(modes.begin(), modes.end(), [&](const ExpectedMode& mode) {
    return std::abs(frequency_hz - mode.frequency_hz) < share * mode.frequency_hz;
  });
}

LineWatch::LineWatch(int axes, double sample_rate_hz, const LineWatchSettings& settings)
    : axes_{axes},
      length_{stillcut::window_length(sample_rate_hz, settings.window_s)},
      kept_{kWindowsKept * length_},
      hop_{length_ / kHopsAWindow},
      bins_{length_ / 2 + 1},
      first_{std::max(2, static_cast<int>(std::ceil(settings.lowest_hz * length_ / sample_rate_hz)) - 1)},
      last_{static_cast<int>(settings.highest_of_rate * length_)},
      bin_hz_{sample_rate_hz / length_},
      settings_{settings},
      fft_{length_},
      window_(length_),
      windowed_(length_),
      spectrum_(bins_),
      inverse_limit_(bins_),
      ratio_(bins_, 0.0F),
      over_floor_(bins_, 0.0F),
      near_mode_(bins_, 0) {
  float sum = 0.0F;
  for (int n = 0; n < length_; ++n) {
    window_[n] = static_cast<float>(0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * n / length_));
    sum += window_[n];
  }
  power_scale_ = 4.0F / (sum * sum);  // a sine of amplitude A gives A^2
  for (auto& axis : residual_)
    axis.assign(2 * kept_, 0.0F);  // also of axes that are not there: the FFT has lanes for three
  for (int a = 0; a < axes_; ++a) {
    power_[a].assign(bins_, 0.0F);
    floor_[a].assign(bins_, 0.0F);
  }
  for (auto& hop : history_) hop.assign(bins_, 0.0F);
  settings_.floor_memory_s = std::max(settings.floor_memory_s, settings.window_s);
  set_prior({}, std::nan(""));
}

bool LineWatch::push(std::span<const Lanes> residual) noexcept {
  if (filled_ == 0 && begin_ + kept_ + hop_ > 2 * kept_) make_room();
  const int at = begin_ + kept_ + filled_;  // past the end: kept() stays whole until the hop is complete
  for (int a = 0; a < axes_; ++a) {
    float* const to = residual_[a].data() + at;
    for (std::size_t i = 0; i < residual.size(); ++i) to[i] = residual[i][a];
  }
  filled_ += static_cast<int>(residual.size());
  if (filled_ < hop_) return false;
  finish_hop();
  return true;
}

bool LineWatch::push(std::span<const float> residual) noexcept {
  Lanes sample;
  for (int a = 0; a < axes_; ++a) sample.set(a, residual[a]);
  return push({&sample, 1});
}

void LineWatch::finish_hop() noexcept {
  begin_ += hop_;
  filled_ = 0;
  hops_in_window_ = std::min(hops_in_window_ + 1, kHopsAWindow);
  found_ = 0;
  if (hops_in_window_ < kHopsAWindow) return;
  transform();
  judge();
  find_candidates();
}

void LineWatch::make_room() noexcept {
  for (int a = 0; a < axes_; ++a) {
    std::copy_n(residual_[a].begin() + begin_, kept_, residual_[a].begin());
  }
  begin_ = 0;
}

void LineWatch::transform() noexcept {
  const float *const x = window(0).data(), *const y = window(1).data(), *const z = window(2).data();
  for (int n = 0; n < length_; ++n) windowed_[n] = window_[n] * Lanes{x[n], y[n], z[n], 0.0F};
  fft_.transform(windowed_, spectrum_);
  for (int b = first_; b <= last_; ++b) {
    const auto [re, im] = spectrum_[b];
    const Lanes power = power_scale_ * (re * re + im * im);
    for (int a = 0; a < axes_; ++a) power_[a][b] = power[a];
  }
}

// What all bins have gained together is a change of the cut or a knock, not a line: the geometric mean of power over
// floor, in which a few lines, however loud, count little. The logarithm is read off the bits of the float (linear
// between powers of two, at most 6 % off), so this costs an addition a bin; noise alone, with its exponential power,
// gives 1.
float LineWatch::common_rise() const noexcept {
  constexpr float kBitsAnOctave = 8388608.0F;  // 2^23
  constexpr float kExponentOfOne = 127.0F;
  constexpr float kMeanOfTheBend = 0.0573F;  // mean of log2(1 + m) - m over the mantissas
  constexpr float kNoiseMean = 0.8327F;      // minus the mean of log2 of an exponential of mean 1
  std::int64_t sum = 0;
  for (int b = first_; b <= last_; ++b) sum += std::bit_cast<std::int32_t>(over_floor_[b]);
  const float mean = static_cast<float>(sum) / static_cast<float>(last_ - first_ + 1);
  return std::exp2(mean / kBitsAnOctave - kExponentOfOne + kMeanOfTheBend + kNoiseMean);
}

void LineWatch::judge() noexcept {
  auto& newest = history_[history_at_];
  history_at_ = (history_at_ + 1) % kHopsToStay;
  const float hop_s = static_cast<float>(hop_ / (bin_hz_ * length_));
  const float settled = 1.0F - std::exp(-hop_s / static_cast<float>(settings_.floor_memory_s));
  const float gain = floor_held_ ? 0.0F : std::max(settled, 1.0F / static_cast<float>(floor_hops_ + 1));
  const auto clip = static_cast<float>(settings_.floor_clip);
  for (int a = 0; a < axes_; ++a) {
    float* const floor = floor_[a].data();
    const float* const power = power_[a].data();
    if (floor_hops_ == 0) std::copy(power + first_, power + last_ + 1, floor + first_);
    float* const over_floor = over_floor_.data();
    for (int b = first_; b <= last_; ++b)
      over_floor[b] = power[b] / (floor[b] > kTiniestFloor ? floor[b] : kTiniestFloor);
    const float common = std::max(1.0F, common_rise());
    common_ = a == 0 ? common : std::max(common_, common);
    const float per_common = 1.0F / common, highest = floor_hops_ < kHopsToLearn ? HUGE_VALF : clip;
    float* const s = newest.data();
    for (int b = first_; b <= last_; ++b) {
      const float f = floor[b] > kTiniestFloor ? floor[b] : kTiniestFloor;
      const float standing_out = over_floor[b] * per_common;
      s[b] = a > 0 && s[b] > standing_out ? s[b] : standing_out;
      const float seen = over_floor[b] < highest ? over_floor[b] : highest;
      floor[b] = f + gain * f * (seen - 1.0F);
    }
  }
  if (!floor_held_) floor_hops_ = std::min(floor_hops_ + 1, 1 << 20);
  for (int b = first_; b <= last_; ++b) {
    float least = history_[0][b];
    for (int h = 1; h < kHopsToStay; ++h) least = std::min(least, history_[h][b]);
    ratio_[b] = least * inverse_limit_[b];
  }
}

void LineWatch::find_candidates() noexcept {
  std::array<int, kCandidates> peak{};
  const float* const ratios = ratio_.data();
  found_ = 0;
  float least = -1.0F;  // that a peak must pass: few do, so it is asked first
  for (int b = first_ + 1; b < last_; ++b) {
    const float ratio = ratios[b];
    if (ratio <= least || ratio < ratios[b - 1] || ratio <= ratios[b + 1]) continue;
    std::size_t at = found_ < kCandidates ? found_++ : kCandidates - 1;
    for (; at > 0 && ratios[peak[at - 1]] < ratio; --at) peak[at] = peak[at - 1];
    peak[at] = b;
    if (found_ == kCandidates) least = ratios[peak[kCandidates - 1]];
  }
  for (std::size_t c = 0; c < found_; ++c) {
    const int b = peak[c];
    int axis = 0;
    for (int a = 1; a < axes_; ++a) {
      if (power_[a][b] * floor_[axis][b] > power_[axis][b] * floor_[a][b]) axis = a;
    }
    candidates_[c] = {frequency_of_peak(axis, b), ratio_[b], axis};
  }
}

double LineWatch::frequency_of_peak(int axis, int bin) const noexcept {
  const float* const p = power_[axis].data() + bin;
  return (bin + std::clamp(hann_peak_offset(std::sqrt(p[-1]), std::sqrt(p[0]), std::sqrt(p[1])), -1.0, 1.0)) * bin_hz_;
}

LineCandidate LineWatch::loudest_near_modes() const noexcept {
  float most = 0.0F;
  int axis = 0, bin = 0;
  for (int a = 0; a < axes_; ++a) {
    for (int b = near_first_; b <= near_last_; ++b) {
      if (near_mode_[b] == 0 || power_[a][b] <= most) continue;
      most = power_[a][b];
      axis = a;
      bin = b;
    }
  }
  if (bin == 0) return {};
  return {frequency_of_peak(axis, bin), std::sqrt(most), axis};
}

void LineWatch::expose(double frequency_hz) noexcept {
  constexpr int kLobe = 3;             // bins on either side that a windowed line fills
  constexpr float kLosesToEnd = 4.0F;  // times the limit that the line now stands above its floor
  const int at = static_cast<int>(std::lround(frequency_hz / bin_hz_));
  for (int a = 0; a < axes_; ++a) {
    for (int b = std::max(first_, at - kLobe); b <= std::min(last_, at + kLobe); ++b) {
      floor_[a][b] = std::min(floor_[a][b], power_[a][b] * inverse_limit_[b] / kLosesToEnd);
    }
  }
}

double LineWatch::ratio_at(double frequency_hz) const noexcept {
  const int b = static_cast<int>(std::lround(frequency_hz / bin_hz_));
  if (b <= first_ || b >= last_) return 0.0;
  return std::max({ratio_[b - 1], ratio_[b], ratio_[b + 1]});
}

void LineWatch::relearn_floor() noexcept { floor_hops_ = 0; }

void LineWatch::clear_window() noexcept {
  for (int a = 0; a < axes_; ++a) std::fill(residual_[a].begin(), residual_[a].end(), 0.0F);
  for (auto& hop : history_) std::fill(hop.begin(), hop.end(), 0.0F);
  hops_in_window_ = 0;
  filled_ = 0;
  found_ = 0;
}

void LineWatch::set_prior(std::span<const ExpectedMode> modes, double margin) noexcept {
  // Predicted unstable: believe sooner; predicted stable with room: ask for more. At most a factor of two in power.
  const double by_margin = std::isnan(margin) ? 1.0 : std::clamp(1.0 + 0.5 * margin, 0.7, 1.4);
  near_first_ = last_;
  near_last_ = first_;
  for (int b = 0; b < bins_; ++b) {
    double by_mode = 1.0;
    near_mode_[b] = 0;
    for (const ExpectedMode& mode : modes) {
      const double distance = std::abs(b * bin_hz_ - mode.frequency_hz) / mode.frequency_hz;
      if (distance < kNearMode) near_mode_[b] = 1;
      // Chatter stands within some tenths of the mode; the map's own error widens that.
      const double width = mode.frequency_hz * (0.05 + 2.0 * mode.damping_ratio);
      const double away = std::abs(b * bin_hz_ - mode.frequency_hz) / width;
      by_mode = std::min(by_mode, away < 1.0 ? 0.7 : 1.0);
    }
    if (near_mode_[b] != 0 && b > first_ && b < last_) {
      near_first_ = std::min(near_first_, b);
      near_last_ = b;
    }
    inverse_limit_[b] = static_cast<float>(1.0 / (settings_.limit * by_mode * by_margin));
  }
}

}  // namespace stillcut
