#include "models/map_refinement.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include "models/floquet.hpp"

namespace stillcut {
namespace {

constexpr double kDeepest = 0.02;          // m, at which a cut that the map calls stable is searched
constexpr double kProbe = 0.005;           // relative shift by which each mode is tried
constexpr double kSharedBelow = 0.7;       // of all sensitivity: less is no mode alone
constexpr double kLeastSensitivity = 0.2;  // of the frequency to a mode's: a flip has none
constexpr double kNextAlias = 3.0;         // so many times as far off as the nearest
constexpr double kNearMode = 0.3;          // relative: modes farther from the frequency are not tried
constexpr double kSameFrequency = 2e-5;    // relative
constexpr int kMostSecants = 12;
constexpr double kNormalDeviation = 1.4826;   // standard deviation over median absolute deviation, normal scatter
constexpr double kMedianEfficiency = 1.2533;  // standard error of a median over that of a mean, normal scatter
constexpr double kLeastStandardError = 1e-3;  // a bin of the monitor's, a few observations long

// Frequency (rad/s) of what grows; nothing where nothing does up to the deepest cut.
std::optional<double> growing_frequency(const LinearCut& cut, std::span<const Mode> modes, const HeardChatter& heard) {
  const FloquetPoint point = floquet_point(cut, modes, heard.spindle_speed, heard.axial_depth);
  if (point.spectral_radius > 1.0) return point.chatter_frequency;
  const DepthLimit limit = floquet_depth_limit(cut, modes, heard.spindle_speed, {.max_depth = kDeepest});
  if (!std::isfinite(limit.depth)) return {};
  return limit.chatter_frequency;
}

// sign * frequency + turns * period frequency.
struct Alias {
  double sign = 1.0, offset = 0.0;
  [[nodiscard]] double of(double frequency) const { return sign * frequency + offset; }
};

// The alias of `frequency` nearest to `heard`; nothing where another one is about as near.
std::optional<Alias> nearest_alias(double frequency, double heard, double tooth_passing) {
  std::array<Alias, 2> nearest;
  std::array<double, 2> distance{};
  for (std::size_t i = 0; i < 2; ++i) {
    const double sign = i == 0 ? 1.0 : -1.0;
    nearest[i] = {sign, std::round((heard - sign * frequency) / tooth_passing) * tooth_passing};
    distance[i] = std::abs(nearest[i].of(frequency) - heard);
  }
  const std::size_t best = distance[0] <= distance[1] ? 0 : 1;
  const double next = std::min(distance[1 - best], tooth_passing - distance[best]);
  if (next < kNextAlias * distance[best]) return {};
  return nearest[best];
}

class Explanation {
 public:
  Explanation(const LinearCut& cut, std::span<const Mode> modes, const HeardChatter& heard)
      : cut_(cut), modes_(modes), heard_(heard) {}

  std::optional<ModeShift> find() {
    const std::optional<double> frequency = growing_frequency(cut_, modes_, heard_);
    if (!frequency) return {};
    const auto alias = nearest_alias(*frequency, heard_.frequency, kTwoPi / period());
    if (!alias) return {};
    alias_ = *alias;
    const double heard_now = alias_.of(*frequency);
    const std::optional<std::size_t> mode = mode_behind(*frequency, heard_now);
    if (!mode) return {};
    return solve(*mode, heard_now);
  }

 private:
  [[nodiscard]] double period() const { return cut_.period_angle() / heard_.spindle_speed; }

  // What would be heard were this mode's frequency so many times what it is.
  std::optional<double> heard_at(std::size_t mode, double ratio) const {
    std::vector<Mode> modes(modes_.begin(), modes_.end());
    modes[mode].natural_frequency *= ratio;
    const std::optional<double> frequency = growing_frequency(cut_, modes, heard_);
    if (!frequency) return {};
    return alias_.of(*frequency);
  }

  // Relative to a shift of the mode, as if the frequency were the mode's own.
  std::optional<std::size_t> mode_behind(double frequency, double heard_now) {
    double all = 0.0, most = 0.0;
    std::optional<std::size_t> behind;
    for (std::size_t m = 0; m < modes_.size(); ++m) {
      const double own = modes_[m].natural_frequency;
      if (std::abs(own - frequency) > kNearMode * frequency) continue;
      const std::optional<double> probed = heard_at(m, 1.0 + kProbe);
      if (!probed) return {};
      const double sensitivity = std::abs(*probed - heard_now) / (kProbe * own);
      all += sensitivity;
      if (sensitivity <= most) continue;
      most = sensitivity;
      slope_ = (*probed - heard_now) / kProbe;
      behind = m;
    }
    if (most < kLeastSensitivity || most < kSharedBelow * all) return {};
    return behind;
  }

  // By secants; what would be heard is nearly a straight line over so small a shift.
  std::optional<ModeShift> solve(std::size_t mode, double heard_now) const {
    double ratio = 1.0, value = heard_now, slope = slope_;
    for (int step = 0; step < kMostSecants; ++step) {
      if (std::abs(value - heard_.frequency) <= kSameFrequency * heard_.frequency) return ModeShift{mode, ratio};
      const double next = ratio + (heard_.frequency - value) / slope;
      if (!(std::abs(next - 1.0) <= kMostModeShift)) return {};
      const std::optional<double> next_value = heard_at(mode, next);
      if (!next_value || *next_value == value) return {};
      slope = (*next_value - value) / (next - ratio);
      ratio = next;
      value = *next_value;
    }
    return {};
  }

  const LinearCut& cut_;
  std::span<const Mode> modes_;
  const HeardChatter& heard_;
  Alias alias_;
  double slope_ = 0.0;  // of what is heard over the ratio of the mode behind it
};

double median_of(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2 == 1) return *middle;
  return 0.5 * (*middle + *std::max_element(values.begin(), middle));
}

ModeEvidence evidence_of(std::span<const ShiftObservation> same, const RefinementSettings& settings) {
  std::vector<double> ratios, deviations;
  for (const ShiftObservation& one : same) ratios.push_back(one.ratio);
  ModeEvidence evidence{same.front().posture, same.front().mode, same.size(), median_of(ratios), 0.0, false};
  for (const double ratio : ratios) deviations.push_back(std::abs(ratio - evidence.ratio));
  evidence.standard_error = std::max(kLeastStandardError, kMedianEfficiency * kNormalDeviation * median_of(deviations) /
                                                              std::sqrt(static_cast<double>(same.size())));
  const double shift = std::abs(evidence.ratio - 1.0);
  evidence.proposed = same.size() >= settings.least_observations && shift >= settings.least_shift &&
                      shift > settings.standard_errors * evidence.standard_error;
  return evidence;
}

}  // namespace

std::optional<ModeShift> shift_of_mode(const LinearCut& cut, std::span<const Mode> modes, const HeardChatter& heard) {
  return Explanation(cut, modes, heard).find();
}

std::vector<ModeEvidence> weigh_shifts(std::vector<ShiftObservation> observations, const RefinementSettings& settings) {
  const auto key = [](const ShiftObservation& one) { return std::pair(one.posture, one.mode); };
  std::sort(observations.begin(), observations.end(), [&](const ShiftObservation& a, const ShiftObservation& b) {
    return std::tuple(key(a), a.ratio) < std::tuple(key(b), b.ratio);
  });
  std::vector<ModeEvidence> evidence;
  for (std::size_t begin = 0, end = 0; begin < observations.size(); begin = end) {
    while (end < observations.size() && key(observations[end]) == key(observations[begin])) ++end;
    evidence.push_back(evidence_of(std::span(observations).subspan(begin, end - begin), settings));
  }
  return evidence;
}

}  // namespace stillcut
