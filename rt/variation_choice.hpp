// Spindle speed variation: the speed swings about a mean, so that no wave meets the one of the tooth before in the same
// phase for long. Asked for where no constant speed in reach is stable. Pure function, fit for the loop.
#pragma once

#include "rt/compensation_limits.hpp"
#include "rt/predicted_margin.hpp"

namespace stillcut {

struct VariationQuestion {
  double speed = 0.0;             // present, rad/s; the mean that is kept where nothing is predicted
  double programmed_speed = 0.0;  // rad/s
  Prediction prediction;
};

struct VariationChoice {
  bool found = false;
  double mean = 0.0;   // rad/s
  double ratio = 0.0;  // amplitude over mean
  double frequency_hz = 0.0;
  double margin_before = 0.0;
  double margin_after = 0.0;  // of the swing; NaN unknown
};

// The swing with the largest predicted margin inside the spindle's range, acceleration and jerk and the tool's window;
// neither its mean nor its turning points lie in a dead zone.
//
// The swing is slow beside the growth of chatter, so that vibration grows and decays with the present speed, and what
// counts is the mean over a swing. Growth is nearly proportional to a/a_lim - 1 on both sides of the limit, so a swing
// is stable where the mean of a/a_lim(n) over it is below 1: its margin is 1 / mean(a/a_lim) - 1. (An estimate of our
// own; the disturbed phase, which helps further, is not counted. A speed without a limit counts 0.)
[[nodiscard]] VariationChoice choose_variation(const VariationQuestion& question,
                                               const CompensationLimits& limits) noexcept;

// The fastest swing of this size that acceleration and jerk allow and the spindle still follows, Hz.
[[nodiscard]] double fastest_swing_hz(const CompensationLimits& limits, double mean, double ratio) noexcept;

}  // namespace stillcut
