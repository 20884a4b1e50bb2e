// Which spindle speed ends this chatter? The measured chatter frequency f_c proposes n_k = 60 f_c / (N k), the speeds
// at which the teeth beat in step with the chatter; the predicted lobes know their pockets. The best speed is one on
// which both agree. Pure function, fit for the loop: its work is bounded.
#pragma once

#include <cstdint>
#include <span>

#include "rt/compensation_limits.hpp"
#include "rt/predicted_margin.hpp"
#include "rt/signals.hpp"

namespace stillcut {

struct SpeedQuestion {
  double chatter_frequency_hz = 0.0;  // NaN: no line heard, or chatter of the structure: the lobes alone answer
  double vibration_hz = 0.0;          // of what has to die out; NaN: not known
  int teeth = 0;
  double speed = 0.0;             // present, rad/s
  double programmed_speed = 0.0;  // rad/s, at which the feed was programmed
  Prediction prediction;
  std::span<const double> tried;  // targets that did not help, rad/s
};

// In rising order of trust. `agreed`: in step with the chatter, and predicted stable however badly the prediction's
// scatter falls; `predicted`: the same from the lobes alone; `in_step`: of n_k, without a prediction that speaks for
// or against it, or with one that knows nothing of this frequency; `improved`: predicted better than the present speed.
enum class SpeedGrounds : std::uint8_t { none, improved, in_step, predicted, agreed };

struct SpeedChoice {
  SpeedGrounds grounds = SpeedGrounds::none;
  double target = 0.0;         // rad/s
  int lobe = 0;                // k; 0: from the lobes alone
  double margin_before = 0.0;  // a_lim/a - 1; NaN unknown
  double margin_after = 0.0;   // the same, of the target itself
  double safe_margin = 0.0;    // see safe_margin_at; NaN unknown
  double move_s = 0.0;         // time of the jerk-limited move
  double decay_s = 0.0;        // expected from there on, to a tenth of the vibration
  std::int32_t limited_by = 0;
  int confidence_percent = 0;

  [[nodiscard]] bool found() const noexcept { return grounds != SpeedGrounds::none; }
};

inline constexpr double kSameTarget = 0.01;  // relative: nearer than this to one that was tried it is the same

[[nodiscard]] bool was_tried(std::span<const double> tried, double speed, double tolerance = kSameTarget) noexcept;

// The speed with the best grounds; among equal ones the one with which the vibration is soonest over: the time of the
// move and that of the decay, which a wide margin makes short (the more so, the slower the vibration). Always inside
// the limits, never predicted worse than the present speed, never one that was tried, nor within half a per cent of the
// present one.
[[nodiscard]] SpeedChoice choose_speed(const SpeedQuestion& question, const CompensationLimits& limits) noexcept;

}  // namespace stillcut
