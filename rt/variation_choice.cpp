#include "rt/variation_choice.hpp"

#include <algorithm>
#include <cmath>

#include "dsp/numbers.hpp"

namespace stillcut {
namespace {

constexpr int kMeans = 40;   // over the spindle's range
constexpr int kPhases = 24;  // of a swing
constexpr double kRatios[] = {0.05, 0.1, 0.15, 0.2, 0.3};
constexpr double kUnpredictedRatio = 0.1;  // where nothing is known
constexpr double kFollowed = 0.7;          // share of the amplitude that must be left behind the spindle's lag
constexpr double kLeastGainOfSwing = 0.1;  // of margin

// What is left of a swing behind a first-order lag.
double left_of_swing(double frequency_hz, double time_constant_s) noexcept {
  const double turn = kTwoPi * frequency_hz * time_constant_s;
  return 1.0 / std::sqrt(1.0 + turn * turn);
}

// Where it turns, a swing stays a while: in no dead zone, as about no mean that lies in one.
bool fits(const CompensationLimits& limits, double programmed_speed, double mean, double ratio) noexcept {
  const double low = mean * (1.0 - ratio), high = mean * (1.0 + ratio);
  return may_stay_at(limits, low) && may_stay_at(limits, mean) && may_stay_at(limits, high) &&
         keeps_feed_per_tooth(limits, low, programmed_speed) && keeps_feed_per_tooth(limits, high, programmed_speed);
}

double margin_of_swing(const Prediction& p, double mean, double ratio) noexcept {
  double sum = 0.0;
  for (int i = 0; i < kPhases; ++i) {
    const double speed = mean * (1.0 + ratio * std::sin(kTwoPi * (i + 0.5) / kPhases));
    sum += 1.0 / (1.0 + margin_at(p, speed));  // a / a_lim: infinite where every depth is unstable
  }
  return kPhases / sum - 1.0;
}

}  // namespace

double fastest_swing_hz(const CompensationLimits& limits, double mean, double ratio) noexcept {
  const double amplitude = mean * ratio;
  const double by_acceleration = limits.spindle.acceleration / (kTwoPi * amplitude);
  const double by_jerk = std::sqrt(limits.spindle.jerk / amplitude) / kTwoPi;
  const double by_lag = std::sqrt(1.0 / (kFollowed * kFollowed) - 1.0) / (kTwoPi * limits.spindle_time_constant_s);
  return std::min({by_acceleration, by_jerk, by_lag, limits.max_variation_hz});
}

VariationChoice choose_variation(const VariationQuestion& q, const CompensationLimits& limits) noexcept {
  VariationChoice best;
  best.margin_before = margin_at(q.prediction, q.speed);
  best.margin_after = kNaN;
  if (!(q.speed > 0.0 && q.programmed_speed > 0.0)) return best;
  const bool predicted = !std::isnan(best.margin_before);
  const auto consider = [&](double mean, double ratio) {
    if (ratio > limits.max_variation || !fits(limits, q.programmed_speed, mean, ratio)) return;
    const double frequency_hz = fastest_swing_hz(limits, mean, ratio);
    const double swung = ratio * left_of_swing(frequency_hz, limits.spindle_time_constant_s);
    const double margin = predicted ? margin_of_swing(q.prediction, mean, swung) : kNaN;
    if (predicted && !(margin > best.margin_before + kLeastGainOfSwing)) return;
    if (best.found && !(margin > best.margin_after)) return;
    best = {true, mean, ratio, frequency_hz, best.margin_before, margin};
  };
  if (!predicted) {
    const double ratio = std::min(kUnpredictedRatio, limits.max_variation);
    constexpr double kInside = 1e-12;  // of rounding
    const double lowest = limits.spindle.min_speed * (1.0 + kInside) / (1.0 - ratio);
    const double highest = limits.spindle.max_speed * (1.0 - kInside) / (1.0 + ratio);
    if (ratio > 0.0 && lowest <= highest) consider(std::clamp(q.speed, lowest, highest), ratio);
    return best;
  }
  const double low = limits.spindle.min_speed, high = limits.spindle.max_speed;
  for (const double ratio : kRatios) {
    consider(q.speed, ratio);
    for (int i = 0; i <= kMeans; ++i) consider(std::lerp(low, high, static_cast<double>(i) / kMeans), ratio);
  }
  return best;
}

}  // namespace stillcut
