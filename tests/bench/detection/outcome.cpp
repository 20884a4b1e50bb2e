#include "tests/bench/detection/outcome.hpp"

#include <algorithm>
#include <cmath>

namespace stillcut::detection {
namespace {

constexpr double kLate_s = 0.5;  // after the truth's moment, an alarm is no detection of it
constexpr double kShort_s = 0.025, kLong_s = 0.25;
constexpr double kStandsFor = 0.5;  // of the forced amplitude: chatter in a cut that was planned as stable
constexpr double kCyclesToFind = 3.0;
constexpr double kFrequencyBy_s = 0.4;  // after the clock of structural chatter
constexpr double kSlowSpan_s = 0.3;     // over which its true frequency is measured

// Standard deviation of the frequency of a real tone in white noise, measured over `length` s.
double cramer_rao_hz(double amplitude, double noise, double rate_hz, double length) {
  const double n = length * rate_hz, snr = 0.5 * amplitude * amplitude / (noise * noise);
  return rate_hz / kTwoPi * std::sqrt(12.0 / (snr * n * (n * n - 1.0)));
}

double amplitude_at(const CutTruth& truth, double time) {
  const auto ms = static_cast<std::size_t>(std::max(0.0, 1e3 * time));
  return ms < truth.amplitude.size() ? truth.amplitude[ms] : 0.0;
}

// Acceleration at the sensor, both axes together.
double bound_at(const CutPlan& plan, const CutTruth& truth, double time, double length) {
  const double omega = kTwoPi * plan.chatter_hz;
  const double amplitude = amplitude_at(truth, time) * omega * omega;
  return amplitude > 0.0 ? cramer_rao_hz(amplitude, truth.noise, plan.sensor_rate_hz, length) : kNaN;
}

void judge_structural(const CutPlan& plan, const CutTruth& truth, const std::vector<Alarm>& alarms,
                      DetectorOutcome& outcome) {
  for (const Alarm& alarm : alarms) {
    if (alarm.time < plan.unstable_from || !alarm.called_structural || outcome.structural_named) continue;
    outcome.structural_named = true;
    outcome.structural_s = alarm.time;
    const double at = std::max(alarm.time, truth.slow_s + kFrequencyBy_s);
    const auto step = static_cast<std::size_t>((at - alarm.time) / kTrack_s);
    outcome.structural_error_hz = alarm.track_hz[std::min(step, alarm.track_hz.size() - 1)] -
                                  line_frequency(truth.motion, slow_line(plan), at - 0.5 * kSlowSpan_s, kSlowSpan_s);
    outcome.structural_found = alarm.time <= truth.slow_s + kCyclesToFind / plan.slow_hz;
  }
}

DetectorOutcome judge_alarms(const CutPlan& plan, const CutTruth& truth, const std::vector<Alarm>& alarms) {
  DetectorOutcome outcome;
  const double sound_until = chatters(plan.kind) ? plan.unstable_from : plan.duration;
  const double until = truth.visible_s + kLate_s;
  for (const Alarm& alarm : alarms) {
    if (alarm.time < sound_until) {
      ++outcome.false_alarms;
      if (alarm.called_regenerative) ++outcome.called_regenerative;
    } else if (!outcome.detected && alarm.time <= until && !alarm.called_structural) {
      outcome.detected = true;
      outcome.alarm_s = alarm.time;
      const TipLine line = tool_line(plan);
      const auto error = [&](double heard_hz, double after) {
        return std::isnan(heard_hz)
                   ? kNaN
                   : heard_hz - line_frequency(truth.motion, line, alarm.time + after - 0.5 * kShort_s, kShort_s);
      };
      outcome.error_25ms_hz = error(alarm.after_25ms_hz, kShort_s);
      outcome.error_250ms_hz = error(alarm.after_250ms_hz, kLong_s);
    }
  }
  const auto hides = [&](const Alarm& alarm) { return alarm.time < sound_until && alarm.end > truth.visible_s; };
  outcome.hidden = !outcome.detected && std::any_of(alarms.begin(), alarms.end(), hides);
  if (plan.slow_hz > 0.0) judge_structural(plan, truth, alarms, outcome);
  return outcome;
}

// Where the depth is sound by theory, which knows no runout, and the truth shows chatter most of the time all the same.
// A harmonic held on the mode leaves nothing between the orders to ask: there theory alone is believed.
bool chatters_before(const CutPlan& plan, const CutTruth& truth) {
  if (plan.kind == CutKind::forced_near_mode) return false;
  const bool undisturbed = plan.kind == CutKind::steady || plan.kind == CutKind::speed_ramp;
  int above = 0, all = 0;
  for (double t = plan.reference_from; t < (undisturbed ? plan.duration : plan.reference_to); t += 1e-3, ++all)
    above += amplitude_at(truth, t) > kStandsFor * truth.forced ? 1 : 0;
  return 2 * above > all;
}

}  // namespace

CutOutcome judge(int index, const CutPlan& plan) {
  const MilledCut cut = mill(plan);
  CutOutcome outcome;
  outcome.index = index;
  outcome.kind = plan.kind;
  outcome.growth = plan.growth;
  outcome.sensor_rate_hz = plan.sensor_rate_hz;
  outcome.chatter_hz = plan.chatter_hz;
  outcome.slow_hz = plan.slow_hz;
  outcome.revolution_s = kTwoPi / plan.setup.cut.spindle_speed;
  outcome.stable_s = chatters(plan.kind) ? plan.unstable_from : plan.duration;
  outcome.snr_db = cut.truth.snr_db;
  outcome.tenth_s = cut.truth.tenth_s;
  outcome.visible_s = cut.truth.visible_s;
  outcome.slow_s = cut.truth.slow_s;
  outcome.not_stable = chatters_before(plan, cut.truth);
  constexpr std::array kAsk{ask_monitor, ask_level, ask_once_per_revolution, ask_energy_ratio, ask_fft};
  for (std::size_t d = 0; d < kDetectors; ++d) outcome.detectors[d] = judge_alarms(plan, cut.truth, kAsk[d](plan, cut));
  const DetectorOutcome& ours = outcome.detectors[0];
  if (ours.detected) {
    outcome.bound_25ms_hz = bound_at(plan, cut.truth, ours.alarm_s + kShort_s, kShort_s);
    outcome.bound_250ms_hz = bound_at(plan, cut.truth, ours.alarm_s + kLong_s, kLong_s);
  }
  return outcome;
}

}  // namespace stillcut::detection
