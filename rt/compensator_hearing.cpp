// What the compensator makes of what the monitor hears: whether it is chatter, of what, for how long it has to last to
// be believed, and when patience is out.
#include <cmath>

#include "dsp/integrity.hpp"
#include "dsp/numbers.hpp"
#include "rt/compensator.hpp"
#include "rt/watch.hpp"

namespace stillcut {
namespace {

constexpr std::int64_t kUnknownKindWaits_ns = 150'000'000;  // a line on a spindle order may still prove to be forced
constexpr std::int64_t kUnpredictedWaits_ns = 1'000'000'000, kUnpredictedFaintWaits_ns = 4'000'000'000;
constexpr double kBeyondDoubt = 3.0;  // of the indicator
constexpr std::int64_t kUnpredictedStructureWaits_ns = 3'000'000'000;
constexpr std::int64_t kPatience_ns =
    6'000'000'000;  // of chatter that goes on whatever is tried; then only a stop is left
constexpr std::int64_t kPatienceDeaf_ns = 3'000'000'000;
constexpr std::int64_t kSaturatedIsChatter_ns = 50'000'000;
constexpr std::int64_t kSaturationLasts_ns = 600'000'000;  // of the doubt, after the last sample at the range's end

}  // namespace

Prediction Compensator::prediction(const CompensatorInputs& in) const noexcept {
  return {in.lobes, in.lobes_ahead, in.axial_depth};
}

// For the depth that the cut is on its way to: a pocket that is left again by the deeper cut is none.
Prediction Compensator::coming_prediction(const CompensatorInputs& in) const noexcept {
  Prediction coming = prediction(in);
  coming.axial_depth = in.coming_depth;
  return coming;
}

// Whether the candidate's effect cannot be told yet: it moves, or has not had the time to act. A saturated sensor is
// doubted for a while after its last sample at the end of its range, so the doubt speaks of the setting only when it
// outlasts that.
bool Compensator::has_its_time(const CompensatorInputs& in) const noexcept {
  const std::int64_t told_late_ns = in.monitor->doubts == kSaturated ? kSaturationLasts_ns : 0;
  return phase_ == Phase::acting && in.now_ns < act_until_ns_ + told_late_ns;
}

// A sensor that a cut drives beyond its range cannot be listened to. Where chatter is predicted, or was heard and is
// being corrected, there is no doubt about what drives it: it is chatter without a line.
bool Compensator::deafened(const CompensatorInputs& in) const noexcept {
  if (in.monitor->doubts != kSaturated || air_since_ns_ != 0) return false;
  return has_its_time(in) || (has_run(saturated_since_ns_, in.now_ns, kSaturatedIsChatter_ns) &&
                              margin_at(coming_prediction(in), in.monitor->speed) < 0.0);
}

ChatterSituation Compensator::situation(const CompensatorInputs& in) const noexcept {
  const MonitorView& heard = *in.monitor;
  ChatterSituation s;
  s.structural = !tool_chatters(in) || heard.kind == ChatterKind::structural;
  s.chatter_frequency_hz = frequency_of_chatter(in);
  s.vibration_hz = s.structural ? heard.structural_frequency_hz : heard.chatter_frequency_hz;
  s.doubtful = is_contradicted(in) && !(heard.indicator >= kBeyondDoubt);
  s.deafened = in.monitor->doubts != kNoDoubt;
  s.patience_is_out =
      settings_.mode == RuntimeMode::active && (has_run(believed_since_ns_, in.now_ns, kPatience_ns) ||
                                                has_run(saturated_since_ns_, in.now_ns, kPatienceDeaf_ns));
  s.teeth = settings_.teeth;
  s.programmed = programmed(in);
  const bool followed = correcting() && settings_.mode == RuntimeMode::active;
  s.present = followed ? motion_.at(motion_time(in.now_ns)).now : correcting() ? s.programmed : uncorrected(in);
  s.set_speed = s.present.speed;
  s.present.speed = heard.speed;
  s.prediction = coming_prediction(in);
  // A feed that was turned brings its own lobes; those of the program, to which every other candidate returns, are not
  // known.
  if (std::abs(s.present.feed_direction - s.programmed.feed_direction) > kTurned) {
    s.prediction.here = s.prediction.ahead = nullptr;
  }
  s.remembered = memory_.recall(place(in));
  return s;
}

// NaN where the tool is thrown about without a line.
double Compensator::frequency_of_chatter(const CompensatorInputs& in) const noexcept {
  const MonitorView& heard = *in.monitor;
  if (!heard.chatter || !heard.single_line) return kNaN;
  return in.lobes == nullptr ? heard.chatter_frequency_hz
                             : base_frequency(*in.lobes, heard.speed, settings_.teeth, heard.chatter_frequency_hz);
}

// Whether what is heard is predicted not to be: by the lobes, or by a robot that is out of the part.
bool Compensator::is_contradicted(const CompensatorInputs& in) const noexcept {
  return in.coming_depth <= 0.0 || safe_margin_at(coming_prediction(in), in.monitor->speed) > 0.0;
}

// Loud, and for so long as it takes to be believed: at once where chatter is predicted. Elsewhere a line of unknown
// kind may be forced, and a burst be that of an entry.
bool Compensator::tool_chatters(const CompensatorInputs& in) const noexcept {
  const MonitorView& heard = *in.monitor;
  if (deafened(in)) return true;
  if (!heard.chatter || !(heard.indicator >= 1.0)) return false;
  const Prediction coming = coming_prediction(in);
  if (margin_at(coming, heard.speed) < 0.0) return true;
  const bool unknown = heard.kind == ChatterKind::unknown;
  const bool faint = !(heard.indicator >= kBeyondDoubt);
  const std::int64_t lasts_ns = !is_contradicted(in) ? (unknown ? kUnknownKindWaits_ns : 0)
                                : unknown || faint   ? kUnpredictedFaintWaits_ns
                                                     : kUnpredictedWaits_ns;
  return has_run(chatter_since_ns_, in.now_ns, lasts_ns);
}

// What sounds like chatter of the structure may be the sweep of a changing speed: it has to be at a mode of the
// structure, where those are known, and to last, where none is predicted.
bool Compensator::structure_chatters(const CompensatorInputs& in) const noexcept {
  const MonitorView& heard = *in.monitor;
  if (!heard.structural) return false;
  if (in.lobes != nullptr && in.lobes->mode_count > 0 && !is_at_a_mode(*in.lobes, heard.structural_frequency_hz))
    return false;
  return !is_contradicted(in) || has_run(chatter_since_ns_, in.now_ns, kUnpredictedStructureWaits_ns);
}

}  // namespace stillcut
