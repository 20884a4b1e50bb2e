// Random questions for a spindle speed, and what may be answered, by the rules of the header in their plainest words.
#pragma once

#include <cmath>
#include <vector>

#include "dsp/numbers.hpp"
#include "rt/speed_choice.hpp"
#include "tests/rt/choice_cases.hpp"

namespace stillcut {

struct SpeedCase {
  CompensationLimits limits;
  KeptPrediction kept;
  std::vector<double> tried;
  double chatter_frequency_hz = 0.0, vibration_hz = 0.0;
  int teeth = 0;
  double speed = 0.0, programmed_speed = 0.0;

  [[nodiscard]] SpeedQuestion question() const {
    return {chatter_frequency_hz, vibration_hz, teeth, speed, programmed_speed, kept.view(), tried};
  }
  [[nodiscard]] double in_step(int k) const { return rpm_to_rad_s(60.0 * chatter_frequency_hz / (teeth * k)); }
};

inline SpeedCase random_speed_case(ChoiceCases& cases) {
  SpeedCase c;
  c.limits = cases.limits();
  c.kept = random_prediction(cases, c.limits.spindle);
  c.chatter_frequency_hz = std::pow(10.0, cases.between(1.0, 3.7));
  if (c.kept.here && c.kept.here->mode_count > 0 && cases.chance(0.5))
    c.chatter_frequency_hz = c.kept.here->modes[0].frequency_hz * cases.between(0.96, 1.04);
  c.vibration_hz = cases.chance(0.2) ? kNaN : c.chatter_frequency_hz;
  c.teeth = cases.whole(1, 6);
  c.speed = cases.speed_in(c.limits);
  c.programmed_speed = cases.chance(0.7) ? c.speed : cases.speed_in(c.limits);
  const int tried = cases.whole(0, 3);
  for (int i = 0; i < tried; ++i)  // likely ones: they are n_k themselves, or anything
    c.tried.push_back(cases.chance(0.7) ? c.in_step(cases.whole(1, 20)) : cases.speed_in(c.limits));
  return c;
}

// What may be chosen, by the rules of the header in their plainest words.
inline bool may_choose(const SpeedCase& c, double speed, double apart_from_tried) {
  const Prediction p = c.kept.view();
  for (const double tried : c.tried)
    if (std::abs(tried - speed) < apart_from_tried * speed) return false;
  // What is known is not left for what is not; and where both are predicted, the prediction speaks for the move.
  const double before = margin_at(p, c.speed), after = margin_at(p, speed), safe = safe_margin_at(p, speed);
  const bool no_better = !std::isnan(before) && !(after > before && safe > before);
  return spindle_may_stay(c.limits, speed) && tooth_may_take(c.limits, speed, c.programmed_speed) &&
         std::abs(speed - c.speed) >= 0.005 * c.speed && !no_better;
}

inline bool heard_is_known(const SpeedCase& c) {
  return c.kept.here && (std::isnan(c.chatter_frequency_hz) || margin_at(c.kept.view(), c.speed) < 0.0 ||
                         explains(*c.kept.here, c.speed, c.chatter_frequency_hz));
}

// The speeds in step that may be chosen; so far up that lobes run into one another no more are looked at.
inline std::vector<double> lobes_in_reach(const SpeedCase& c) {
  std::vector<double> list;
  int looked_at = 0;
  for (int k = 1; k < 5000 && looked_at <= 64; ++k) {
    const double speed = c.in_step(k);
    if (speed > c.limits.spindle.max_speed) continue;
    ++looked_at;
    if (may_choose(c, speed, 0.01)) list.push_back(speed);
  }
  return list;
}

inline std::vector<double> points_in_reach(const SpeedCase& c) {
  std::vector<double> list;
  if (!c.kept.here) return list;
  for (int i = 0; i < c.kept.here->point_count; ++i) {
    const double speed = c.kept.here->points[static_cast<std::size_t>(i)].speed;
    if (may_choose(c, speed, 0.025)) list.push_back(speed);
  }
  return list;
}

inline bool is_safe(const SpeedCase& c, double speed) { return safe_margin_at(c.kept.view(), speed) > 0.0; }

// From rest to rest of the acceleration: with a hold at its limit, or without.
inline double fastest_move_s(const SpeedCase& c, double target) {
  const double change = std::abs(target - c.speed), a = c.limits.spindle.acceleration, j = c.limits.spindle.jerk;
  return change > a * a / j ? change / a + a / j : 2.0 * std::sqrt(change / j);
}

// Of the mode that is nearest to what vibrates, 2 % and 500 Hz where nothing is known: down to a tenth, with all of its
// damping far from the limit, with none at it, and in proportion between.
inline double decay_s(const SpeedCase& c, double target) {
  const double frequency_hz = std::isnan(c.vibration_hz) ? 500.0 : c.vibration_hz;
  double damping = 0.02, apart = 1e9;
  for (int m = 0; c.kept.here && m < c.kept.here->mode_count; ++m) {
    const ModeSummary& mode = c.kept.here->modes[static_cast<std::size_t>(m)];
    if (std::abs(mode.frequency_hz - frequency_hz) >= apart) continue;
    apart = std::abs(mode.frequency_hz - frequency_hz);
    damping = mode.damping_ratio;
  }
  double margin = safe_margin_at(c.kept.view(), target);
  if (std::isnan(margin) || margin < 0.02) margin = 0.02;
  if (margin > 1.0) margin = 1.0;
  return std::log(10.0) / (damping * kTwoPi * frequency_hz * margin / (1.0 + margin));
}

}  // namespace stillcut
