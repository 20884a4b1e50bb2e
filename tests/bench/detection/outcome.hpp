// What each detector made of one cut, held against the truth: plain numbers, small enough to keep for every cut.
#pragma once

#include "tests/bench/detection/detectors.hpp"

namespace stillcut::detection {

struct DetectorOutcome {
  bool detected = false;        // an alarm from where the depth began to rise until 0.5 s after the truth's own moment
  bool hidden = false;          // not detected, as an episode that had begun falsely stood open when it was visible
  double alarm_s = kNaN;        // the first of these
  int false_alarms = 0;         // in sound cutting
  int called_regenerative = 0;  // of the false ones
  bool structural_found = false;  // a structural alarm within three cycles of the clock's start
  bool structural_named = false;  // at any time after
  double structural_s = kNaN, structural_error_hz = kNaN;  // 0.4 s after the clock's start, or at the alarm
  double error_25ms_hz = kNaN, error_250ms_hz = kNaN;
};

struct CutOutcome {
  int index = 0;
  CutKind kind = CutKind::steady;
  double growth = 0.0, snr_db = 0.0, sensor_rate_hz = 0.0, chatter_hz = 0.0, slow_hz = 0.0;
  double revolution_s = 0.0, stable_s = 0.0;
  double tenth_s = kNaN, visible_s = kNaN, slow_s = kNaN;
  bool not_stable = false;                             // planned as a stable cut, but the truth shows chatter: left out
  double bound_25ms_hz = kNaN, bound_250ms_hz = kNaN;  // Cramer-Rao, at the amplitude it had when it was measured
  std::array<DetectorOutcome, kDetectors> detectors;
};

CutOutcome judge(int index, const CutPlan& plan);

}  // namespace stillcut::detection
