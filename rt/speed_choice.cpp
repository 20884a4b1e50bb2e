#include "rt/speed_choice.hpp"

#include <algorithm>
#include <cmath>

#include "dsp/numbers.hpp"
#include "models/lobe_diagram.hpp"

namespace stillcut {
namespace {

constexpr double kFrequencyError = 0.01;  // of f_c and of the spindle's speed: the pocket must be that wide
constexpr double kAlreadyThere = 0.005;   // a target this near is no move
constexpr double kSameTarget = 0.01;      // of one already tried
constexpr double kHighestLobe = 1e6;      // beyond it speeds and frequency do not belong together
constexpr int kMostLobes = 512;           // bounds the work; so high up the lobes run into one another

double predicted_margin(const SpeedQuestion& q, double speed) noexcept {
  return q.lobes == nullptr ? kNaN : margin_at(*q.lobes, speed, q.axial_depth);
}

// The worst margin within the error of the target.
double safe_margin(const SpeedQuestion& q, double speed) noexcept {
  const double low = std::max(q.limits.min_speed, speed * (1.0 - kFrequencyError));
  const double high = std::min(q.limits.max_speed, speed * (1.0 + kFrequencyError));
  const double middle = predicted_margin(q, speed);
  const double sides = std::min(predicted_margin(q, low), predicted_margin(q, high));
  return std::isnan(middle) || std::isnan(sides) ? middle : std::min(middle, sides);
}

bool was_tried(const SpeedQuestion& q, double speed) noexcept {
  return std::any_of(q.tried.begin(), q.tried.end(),
                     [&](double t) { return std::abs(t - speed) < kSameTarget * speed; });
}

}  // namespace

SpeedChoice choose_speed(const SpeedQuestion& q) noexcept {
  SpeedChoice best;
  best.margin_before = predicted_margin(q, q.speed);
  best.margin_after = kNaN;
  const double in_step = kTwoPi * q.chatter_frequency_hz / q.teeth;  // k = 1
  const double highest_lobe = in_step / q.limits.min_speed;
  const bool answerable = q.speed > 0.0 && q.teeth > 0 && in_step > 0.0 && highest_lobe < kHighestLobe;
  if (!answerable || !(q.limits.max_speed >= q.limits.min_speed)) {
    best.limited_by = kNoStableSettingKnown;
    return best;
  }
  const int first = std::max(1, static_cast<int>(std::ceil(in_step / q.limits.max_speed)));
  const int last = std::min(static_cast<int>(highest_lobe), first + kMostLobes);
  for (int k = first; k <= last; ++k) {
    const double target = in_step / k;
    if (target < q.limits.min_speed || target > q.limits.max_speed) continue;  // by the last bit
    const double move = std::abs(target - q.speed);
    if (move < kAlreadyThere * q.speed || was_tried(q, target)) continue;
    const double margin = safe_margin(q, target);
    if (!std::isnan(margin) && !std::isnan(best.margin_before) && margin <= best.margin_before) continue;  // do no harm
    const bool stable = margin > 0.0;
    const bool best_stable = best.margin_after > 0.0;
    const bool better = !best.found || (stable && !best_stable) ||
                        (stable == best_stable && (stable || std::isnan(margin) ? move < std::abs(best.target - q.speed)
                                                                                : margin > best.margin_after));
    if (better) {
      best.found = true;
      best.target = target;
      best.lobe = k;
      best.margin_after = margin;
    }
  }
  if (!best.found) {
    best.limited_by = kNoStableSettingKnown | kLimitedBySpeedRange;
    return best;
  }
  // Heard and predicted agree: confident. Nothing predicted: the measured frequency alone. A prediction that says the
  // present cut is stable has just been contradicted.
  best.confidence_percent = std::isnan(best.margin_after) ? 50
                            : best.margin_after <= 0.0    ? 30
                            : best.margin_before < 0.0    ? 80
                                                          : 50;
  return best;
}

}  // namespace stillcut
