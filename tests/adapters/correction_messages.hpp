// Corrections as the monitor sends them, for the tests of the adapters.
#pragma once

#include "rt/signals.hpp"

namespace stillcut {

inline Correction speed_correction(double spindle_speed_rpm, double feed_override) {
  Correction correction;
  correction.mode = RuntimeMode::active;
  correction.kind = CorrectionKind::spindle_speed;
  correction.valid_for_ms = 500;
  correction.spindle_speed_rpm = correction.spindle_speed_target_rpm = spindle_speed_rpm;
  correction.feed_override = feed_override;
  return correction;
}

}  // namespace stillcut
