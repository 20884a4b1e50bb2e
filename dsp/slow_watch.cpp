#include "dsp/slow_watch.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace stillcut {
namespace {

constexpr double kThinned_hz = 500.0;
constexpr double kLowest_hz = 4.0, kBandRatio = 1.0905077;  // an eighth of an octave
constexpr double kCycles = 2.0;                             // of the window
constexpr double kNoiseFalls_s = 2.0, kNoiseRises_s = 4.0;
// Power over that of noise in a band of that width: the fewer axes, the more does noise alone vary.
constexpr std::array<double, kMaxAxes> kNoiseLimit{24.0, 16.0, 12.0};
constexpr double kSlowLimit = 3.0;  // power over the band's own floor
constexpr double kSlowFloorMemory_s = 1.0, kAloneFloorMemory_s = 8.0, kSlowFloorClip = 4.0, kSlowFloorLearns_s = 0.4;
constexpr double kLeastStanding = 0.985, kLeastGrowth = 1.03, kMostGrowth = 2.0;  // a cycle; more: a window that fills
constexpr double kCyclesToGrow = 0.75, kSecondsToGrow = 0.05;  // beyond the two windows that show it: the longer
constexpr double kFast_hz = 20.0;
constexpr double kFadingCounts = 2.0, kUnsureCounts = 0.25, kMostEvidence = 4.0;
constexpr double kCoherent = 0.7, kInBand = 0.2, kTurnMemory = 0.7;
constexpr double kOverBelow = 0.8, kOverAbove = 0.3;  // power over that an octave below and above
constexpr int kOctave = 8;                            // bands
constexpr double kFullTurn = 2.0 * std::numbers::pi;

}  // namespace

SlowWatch::SlowWatch(int axes, double sample_rate_hz)
    : axes_{axes},
      thinned_{std::max(1, static_cast<int>(std::lround(sample_rate_hz / kThinned_hz)))},
      sample_rate_hz_{sample_rate_hz} {
  // The mean of the mean of the mean: nothing near a multiple of the thinned rate comes through as something slow.
  std::vector<double> box(static_cast<std::size_t>(thinned_), 1.0 / thinned_), kernel = box;
  for (int pass = 0; pass < 2; ++pass) {
    std::vector<double> next(kernel.size() + box.size() - 1, 0.0);
    for (std::size_t i = 0; i < kernel.size(); ++i) {
      for (std::size_t j = 0; j < box.size(); ++j) next[i + j] += kernel[i] * box[j];
    }
    kernel = next;
  }
  kernel_.assign(3 * box.size(), 0.0F);
  std::copy(kernel.begin(), kernel.end(), kernel_.begin());
  for (auto& axis : history_) axis.assign(2 * kHistory, 0.0F);
  const double rate = sample_rate_hz_ / thinned_;
  double hz = kLowest_hz;
  for (int b = 0; b < kBands; ++b, hz *= kBandRatio) {
    Band band;
    band.frequency_hz = hz;
    band.length = std::min(kHistory, static_cast<int>(std::lround(kCycles * rate / hz)));
    double sum = 0.0;
    for (int n = 0; n < band.length; ++n) sum += 0.5 - 0.5 * std::cos(kFullTurn * (n + 0.5) / band.length);
    std::complex<double> mean = 0.0;
    std::vector<std::complex<double>> window;
    for (int n = 0; n < band.length; ++n) {
      const double weight = (0.5 - 0.5 * std::cos(kFullTurn * (n + 0.5) / band.length)) * 2.0 / sum;
      const std::complex<double> w = std::polar(weight, -kFullTurn * hz / rate * n);
      window.push_back(w);
      mean += w;
    }
    mean /= band.length;  // gravity must leave nothing
    const std::size_t whole = (window.size() + Lanes::kCount - 1) / Lanes::kCount * Lanes::kCount;
    band.re.assign(whole - window.size(), 0.0F);
    band.im = band.re;
    for (const auto& w : window) {
      band.re.push_back(static_cast<float>((w - mean).real()));
      band.im.push_back(static_cast<float>((w - mean).imag()));
    }
    bands_.push_back(std::move(band));
  }
}

void SlowWatch::clear() noexcept {
  samples_ = steps_ = 0;
  forget_evidence();
}

void SlowWatch::thin_out(std::span<const Lanes> x) noexcept {
  const float *const first = kernel_.data() + in_sample_, *const second = first + thinned_,
                     *const third = second + thinned_;
  std::array<Lanes, 3> sums = sums_;
  for (std::size_t i = 0; i < x.size(); ++i) {
    sums[0] += third[i] * x[i];
    sums[1] += second[i] * x[i];
    sums[2] += first[i] * x[i];
  }
  sums_ = sums;
  in_sample_ += static_cast<int>(x.size());
}

bool SlowWatch::push(std::span<const Lanes> x) noexcept {
  bool stepped = false;
  while (!x.empty()) {
    const std::size_t n = std::min(x.size(), static_cast<std::size_t>(thinned_ - in_sample_));
    thin_out(x.first(n));
    x = x.subspan(n);
    if (in_sample_ == thinned_) stepped = keep_thinned() || stepped;
  }
  return stepped;
}

bool SlowWatch::push(std::span<const float> x) noexcept {
  Lanes sample;
  for (int a = 0; a < axes_; ++a) sample.set(a, x[a]);
  return push({&sample, 1});
}

bool SlowWatch::keep_thinned() noexcept {
  in_sample_ = 0;
  for (int a = 0; a < axes_; ++a) history_[a][at_] = history_[a][at_ + kHistory] = sums_[0][a];
  sums_ = {sums_[1], sums_[2], Lanes{}};
  at_ = (at_ + 1) % kHistory;
  ++samples_;
  if (++in_step_ < kStep) return false;
  in_step_ = 0;
  finish_step();
  return true;
}

void SlowWatch::finish_step() noexcept {
  step_ = (step_ + 1) % kStepsKept;
  ++steps_;
  if (!floor_held_) ++floor_steps_;
  for (Band& band : bands_) listen(band);
  // Noise alone has a power in proportion to a band's width, which goes with its frequency: the lower half of all bands
  // tells how much, whatever lines there are.
  std::array<double, kBands> density{};
  for (int b = 0; b < kBands; ++b) density[b] = bands_[b].power / bands_[b].frequency_hz;
  std::nth_element(density.begin(), density.begin() + kBands * 2 / 5, density.end());
  const double now = density[kBands * 2 / 5];
  const double memory_s = now > noise_ ? kNoiseRises_s : kNoiseFalls_s;
  noise_ += std::max(step_s() / memory_s, 1.0 / static_cast<double>(steps_)) * (now - noise_);
  for (Band& band : bands_) judge(band);
}

void SlowWatch::listen(Band& band) noexcept {
  auto& now = band.heard[step_];
  band.power = 0.0;
  if (samples_ < band.length) {
    now.fill(0.0F);
    return;
  }
  // Four weights at once and all axes side by side, so that no sum waits for the last one; an absent axis is silent.
  const std::size_t weights = band.re.size();
  std::array<const float*, kMaxAxes> newest{};
  for (int a = 0; a < kMaxAxes; ++a) newest[a] = history_[a].data() + at_ + kHistory - weights;
  std::array<Lanes, kMaxAxes> re{}, im{};
  for (std::size_t n = 0; n < weights; n += Lanes::kCount) {
    const Lanes w_re = Lanes::load(&band.re[n]), w_im = Lanes::load(&band.im[n]);
    for (int a = 0; a < kMaxAxes; ++a) {
      const Lanes x = Lanes::load(newest[a] + n);
      re[a] += x * w_re;
      im[a] += x * w_im;
    }
  }
  for (int a = 0; a < axes_; ++a) {
    now[a] = {sum(re[a]), sum(im[a])};
    band.power += std::norm(now[a]);
  }
  const double learned = 1.0 / static_cast<double>(std::max(1L, floor_steps_));
  // A line that stands alone may be chatter that grows slowly: its floor must not grow along.
  const double memory_s = band.alone && band.power > band.floor ? kAloneFloorMemory_s : kSlowFloorMemory_s;
  const double gain = floor_held_ ? 0.0 : std::max(step_s() / memory_s, learned);
  const bool young = static_cast<double>(floor_steps_) * step_s() < kSlowFloorLearns_s;
  if (!(band.floor > 0.0)) band.floor = band.power;
  band.floor += gain * (std::min(band.power, (young ? 1e6 : kSlowFloorClip) * band.floor) - band.floor);
}

// Chatter stands out, turns steadily and grows from cycle to cycle, or stands. What dies out is a mode that rings.
void SlowWatch::judge(Band& band) noexcept {
  band.line = {};
  const int cycle = std::max(1, static_cast<int>(std::lround(1.0 / (band.frequency_hz * step_s()))));
  const double cycle_s = cycle * step_s();
  const auto& now = band.heard[step_];
  const auto& then = band.heard[(step_ + kStepsKept - cycle) % kStepsKept];
  std::complex<double> turned = 0.0;
  double before = 0.0;
  for (int a = 0; a < axes_; ++a) {
    turned += std::complex<double>(now[a]) * std::conj(std::complex<double>(then[a]));
    before += std::norm(then[a]);
  }
  if (steps_ <= cycle || !(before > 0.0) || !(band.power > 0.0)) {
    band.evidence = 0.0;
    return;
  }
  band.turned = kTurnMemory * band.turned + turned;
  SlowLine& line = band.line;
  line.frequency_hz = (std::round(band.frequency_hz * cycle_s) + std::arg(band.turned) / kFullTurn) / cycle_s;
  line.amplitude = std::sqrt(band.power);
  line.ratio = std::min(band.power / (kSlowLimit * band.floor),
                        band.power / (kNoiseLimit[axes_ - 1] * noise_ * band.frequency_hz));
  line.cycle_growth = std::pow(band.power / before, 0.5 / (band.frequency_hz * cycle_s));
  const bool coherent = std::abs(turned) > kCoherent * std::sqrt(band.power * before) &&
                        std::abs(line.frequency_hz / band.frequency_hz - 1.0) < kInBand;
  // A line stands alone: an octave below its own window hears nothing of it, an octave above a quarter of its power.
  const std::ptrdiff_t at = &band - bands_.data(), below = at - kOctave, above = at + kOctave;
  const bool tonal = (below < 0 || band.power > kOverBelow * bands_[below].power) &&
                     (above >= kBands || band.power > kOverAbove * bands_[above].power);
  const bool peak =
      (at < 1 || band.power >= bands_[at - 1].power) && (at + 1 >= kBands || band.power >= bands_[at + 1].power);
  band.alone = coherent && tonal && peak;
  const double cycles = band.frequency_hz * step_s();
  // The faster a line, the more of its cycles are asked for: below a tenth of a second many things grow.
  const double asked = std::max({kCyclesToGrow, kSecondsToGrow * band.frequency_hz,
                                 (band.frequency_hz / kFast_hz) * (band.frequency_hz / kFast_hz)});
  double gain = -kUnsureCounts;
  if (line.ratio < 1.0 || line.cycle_growth < kLeastStanding) {
    gain = -kFadingCounts;
  } else if (coherent && tonal && line.cycle_growth < kMostGrowth) {
    gain = line.cycle_growth > kLeastGrowth ? 1.0 / asked : 0.0;
  }
  band.evidence = std::clamp(band.evidence + cycles * gain, 0.0, kMostEvidence);
  line.evidence = band.evidence;
}

SlowLine SlowWatch::strongest_near(const Band& band) const noexcept {
  const Band* best = &band;
  for (const Band& other : bands_) {
    const bool near = std::abs(other.frequency_hz - band.frequency_hz) < 0.2 * band.frequency_hz;
    if (near && other.evidence >= 0.5 * band.evidence && other.power > best->power) best = &other;
  }
  SlowLine line = best->line;
  line.evidence = band.evidence;
  return line;
}

SlowLine SlowWatch::line_at(double frequency_hz) const noexcept {
  const auto near = std::min_element(bands_.begin(), bands_.end(), [&](const Band& a, const Band& b) {
    return std::abs(a.frequency_hz - frequency_hz) < std::abs(b.frequency_hz - frequency_hz);
  });
  return near->line;
}

void SlowWatch::relearn_floor() noexcept {
  floor_steps_ = 0;
  forget_evidence();
}

void SlowWatch::forget_evidence() noexcept {
  for (Band& band : bands_) band.evidence = 0.0;
}

}  // namespace stillcut
