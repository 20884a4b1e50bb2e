#include "dsp/decay_watch.hpp"

#include <algorithm>
#include <cmath>

#include "dsp/hann_line.hpp"
#include "dsp/numbers.hpp"

namespace stillcut {
namespace {

constexpr float kDecayMemory = 480.0F;  // hops, 1.5 s
constexpr int kHopsToMeasure = 240;
constexpr float kLeastOverOne = 0.4F, kLeastOverTwo = 0.15F;  // of the power: below it is what chance gives

}  // namespace

void DecayWatch::step(const LineWatch& watch, std::span<const ExpectedMode> modes) noexcept {
  if (hops_ == 0) {
    modes_ = 0;
    for (const ExpectedMode& mode : modes) {
      const bool watched = mode.frequency_hz > watch.lowest_hz() && mode.frequency_hz < watch.highest_hz();
      if (watched && modes_ < kMostModes) heard_[modes_++] = {mode.frequency_hz, {}, 0.0F, {}, {}};
    }
    window_s_ = 1.0 / watch.bin_hz();
  }
  const auto now = static_cast<std::size_t>(hops_) % kKept, one = (now + kKept - kHopsAWindow) % kKept,
             two = (now + 1) % kKept;  // the oldest that is kept
  ++hops_;
  const bool full = hops_ >= static_cast<int>(kKept);  // so that every correlation has both its windows
  const float gain =
      full ? std::max(1.0F / kDecayMemory, 1.0F / static_cast<float>(hops_ + 1 - static_cast<int>(kKept))) : 0.0F;
  for (std::size_t m = 0; m < modes_; ++m) {
    Heard& mode = heard_[m];
    const HannLine line{mode.frequency_hz / watch.bin_hz(), watch.window_length()};
    float power = 0.0F;
    Complex over_one, over_two;
    const ComplexLanes heard = line.in(watch.spectrum());
    for (int a = 0; a < axes_; ++a) {
      const Complex z = mode.line[now][a] = {heard.re[a], heard.im[a]};
      power += std::norm(z);
      over_one += z * std::conj(mode.line[one][a]);
      over_two += z * std::conj(mode.line[two][a]);
    }
    mode.power += gain * (power - mode.power);
    mode.over_one += gain * (over_one - mode.over_one);
    mode.over_two += gain * (over_two - mode.over_two);
  }
}

ModeDecay DecayWatch::slowest() const noexcept {
  ModeDecay slowest{kNaN, kNaN};
  if (hops_ < kHopsToMeasure) return slowest;
  for (std::size_t m = 0; m < modes_; ++m) {
    const float one = std::abs(heard_[m].over_one), two = std::abs(heard_[m].over_two);
    if (!(one > kLeastOverOne * heard_[m].power) || !(two > kLeastOverTwo * heard_[m].power)) continue;
    const double per_s = std::log(double{one} / double{two}) / window_s_;
    if (!(per_s >= slowest.per_s)) slowest = {heard_[m].frequency_hz, per_s};
  }
  return slowest;
}

}  // namespace stillcut
