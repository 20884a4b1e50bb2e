#include "models/chatter_truth.hpp"

#include <algorithm>
#include <cmath>

#include "models/machining.hpp"

namespace stillcut {
namespace {

constexpr double kMillisecond = 1e-3;
constexpr std::size_t kHalfWindow_ms = 40;  // the envelope sees half a period of 8 Hz on each side
constexpr std::size_t kLasting_ms = 300;
constexpr double kNotDecayed = 0.9;     // of the envelope, after that time
constexpr double kDiedDown = 0.1;       // of the peak
constexpr std::size_t kQuiet_ms = 100;  // below that for so long

}  // namespace

void ChatterTruth::add(double time, double spindle_angle, const Eigen::Vector3d& displacement) {
  past_.push_back({spindle_angle, displacement});
  Eigen::Vector3d unrepeated = Eigen::Vector3d::Zero();
  const double whole = spindle_angle - past_.front().angle;
  if (whole >= static_cast<double>(kRevolutions) * kTwoPi) {
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (std::size_t r = 0; r < kRevolutions; ++r) {
      const double wanted = spindle_angle - static_cast<double>(r + 1) * kTwoPi;
      std::size_t& at = before_[r];
      while (past_[at + 1].angle <= wanted) ++at;
      const Sample &a = past_[at], &b = past_[at + 1];
      mean += a.displacement + (wanted - a.angle) / (b.angle - a.angle) * (b.displacement - a.displacement);
    }
    unrepeated = displacement - mean / static_cast<double>(kRevolutions);
  }
  for (Eigen::Index axis = 0; axis < 2; ++axis)
    crossed_[static_cast<std::size_t>(axis)] += unrepeated[axis] * last_[axis] < 0.0 ? 1 : 0;
  last_ = unrepeated;
  const auto millisecond = static_cast<std::size_t>(time / kMillisecond);
  peaks_.resize(std::max(peaks_.size(), millisecond + 1), 0.0);
  crossings_.resize(peaks_.size(), crossed_);
  peaks_[millisecond] = std::max(peaks_[millisecond], unrepeated.norm());
  crossings_[millisecond] = crossed_;
}

std::vector<double> ChatterTruth::envelope() const {
  std::vector<double> envelope(peaks_.size());
  for (std::size_t i = 0; i < peaks_.size(); ++i) {
    const std::size_t from = i < kHalfWindow_ms ? 0 : i - kHalfWindow_ms;
    const std::size_t to = std::min(i + kHalfWindow_ms + 1, peaks_.size());
    envelope[i] = *std::max_element(peaks_.begin() + static_cast<std::ptrdiff_t>(from),
                                    peaks_.begin() + static_cast<std::ptrdiff_t>(to));
  }
  return envelope;
}

// Of the axis that crosses less often: noise and sidebands on the still axis only add crossings.
double ChatterTruth::frequency_hz(std::size_t from, std::size_t to) const {
  if (to <= from + 1) return 0.0;
  const auto crossed = [&](std::size_t axis) { return crossings_[to - 1][axis] - crossings_[from][axis]; };
  return 0.5 * std::min(crossed(0), crossed(1)) / (static_cast<double>(to - 1 - from) * kMillisecond);
}

std::vector<ChatterSpell> ChatterTruth::spells() const {
  const std::vector<double> height = envelope();
  std::vector<ChatterSpell> spells;
  for (std::size_t i = 0; i + kLasting_ms < height.size(); ++i) {
    const auto begin = height.begin() + static_cast<std::ptrdiff_t>(i);
    const bool lasts = std::all_of(begin, begin + kLasting_ms, [](double h) { return h > kLimit; });
    if (!lasts || height[i + kLasting_ms] < kNotDecayed * height[i]) continue;
    ChatterSpell spell;
    spell.start = static_cast<double>(i) * kMillisecond;
    std::size_t quiet = 0, j = i;
    for (; j < height.size() && quiet < kQuiet_ms; ++j) {
      spell.peak = std::max(spell.peak, height[j]);
      quiet = height[j] < std::max(kLimit, kDiedDown * spell.peak) ? quiet + 1 : 0;
    }
    spell.died_down = quiet == kQuiet_ms;
    const std::size_t end = spell.died_down ? j - kQuiet_ms : height.size();
    spell.end = static_cast<double>(end) * kMillisecond;
    spell.frequency_hz = frequency_hz(i, end);
    spells.push_back(spell);
    i = j;
  }
  return spells;
}

}  // namespace stillcut
