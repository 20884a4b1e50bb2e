// What a run in closed loop is measured by, from the messages of the monitor and what the simulated machine knows of
// itself: how soon the chatter was down, how often the target changed, whether it came back, whether it was stopped.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "dsp/numbers.hpp"
#include "tests/tools/closed_loop/random_cell.hpp"
#include "tools/closed_loop.hpp"

namespace stillcut::campaign {

// One setting that was asked for: a speed target, a variation, a direction, a feed, a stop, or the release.
struct Asked {
  double time = 0.0;  // s
  CorrectionKind kind = CorrectionKind::release;
  double value = 0.0;  // rad/s, ratio, rad, override; 0: stop, release
};

struct RunMetrics {
  bool chattered = false;      // by the machine's truth
  double chatter_from = kNaN;  // s
  double chatter_hz = kNaN;    // truth
  double ended = kNaN;         // s: of the last spell; kFar: it lasts until the exit
  int spells = 0;
  double alarm = kNaN;       // s: first chatter_onset after the sound depth was left
  int times_back = 0;        // the chatter, after it had been down
  int onsets = 0;            // in all
  std::vector<Asked> asked;  // in time, one for each change of setting
  int targets = 0;           // distinct settings, releases not counted
  bool limit_cycle = false;  // a setting that was left comes again, or chatter comes back again and again
  bool stopped = false;      // a stop request was followed
  std::string reason;        // of it, or of the last message
  double allowed = kNaN;     // s after the alarm: the jerk-limited move, four spindle time constants, 0.1 s

  // Amplitude of the chatter: sqrt(2) times the rms of the motion that does not repeat, over 50 ms (250 ms where the
  // chatter is slower than 80 Hz), of what of it is faster than 80 Hz where the chatter is.
  double peak = 0.0;  // m
  // s after the alarm: below a tenth of the peak for a second at least, and never again above three tenths
  double down_after = kNaN;
  double down_to_noise_after = kNaN;             // s, the same, where twice `in_pocket` counts as down too
  double below_for_good_after = kNaN;            // s, never again above a tenth, noise or not
  double at_alarm = kNaN, at_correction = kNaN;  // m
  double sound = kNaN;                           // m, before the deep cut
  double settled = kNaN;                         // m, 95 % of the second half of the deep cut
  double in_pocket = kNaN;  // m, the same where the pocket's speed is programmed and nothing corrected

  [[nodiscard]] bool in_time() const { return down_after <= allowed; }
  [[nodiscard]] bool in_time_but_for_noise() const { return down_to_noise_after <= allowed; }
  // A correction came before the chatter could be seen, and it stayed so.
  [[nodiscard]] bool forestalled() const { return !chattered && !std::isnan(alarm) && !asked.empty(); }
  // What the noise of the force leaves at the pocket's own speed is more than a tenth of the peak: it hides whether the
  // chatter is down.
  [[nodiscard]] bool hidden() const { return in_pocket > 0.1 * peak; }
  static constexpr double kFar = 1e9;
};

// The cell's machine has run to its end and `heard` is what the monitor said; `in_pocket` as in RunMetrics.
RunMetrics measure(const RandomCell& cell, const VirtualMachine& machine, const Heard& heard, double in_pocket = kNaN);

// Writes the cell to `folder` and runs it there.
RunMetrics run_cell(const RandomCell& cell, const std::filesystem::path& folder);

}  // namespace stillcut::campaign
