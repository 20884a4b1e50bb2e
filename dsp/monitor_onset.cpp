// How the monitor comes to call a line chatter: it must stand or grow, keep its phase from revolution to revolution,
// and not belong to the spindle (monitor_classify.cpp).
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <utility>

#include "dsp/monitor.hpp"
#include "dsp/numbers.hpp"

namespace stillcut {
namespace {

// Evidence that a suspect must gather: a hop in which it stands where it was counts one, a hop in which it still grows
// three. A mode that rings after a knock fades, so it gathers little; it grows only while it fills the window, and then
// is no suspect yet.
constexpr double kEnoughFree = 9.0, kEnoughOnOrder = 16.0, kGrowingCounts = 3.0;
constexpr double kGrows = 1.15, kStands = 0.8;  // amplitude of the last quarter of the window over any before
constexpr double kHoldsPeak = 0.9;              // and over the largest since it was suspected
constexpr double kSteadyCycles = 0.12;          // by which its turn in a revolution may change
// After such a change of the whole vibration's power twice as much is asked for: after a fall the tool has left the cut
// for a moment, a rise out of the cut may be an entry, which the synchronous level tells of a few revolutions later.
constexpr double kFallToDoubt = 3.0, kRiseToDoubt = 1.5, kDoubtAsks = 2.0, kNewCut_s = 0.3;
// A tool that is thrown about leaves no single line: all bins stand far over their floors, for a tenth of a second.
constexpr double kWild = 12.0;
constexpr int kWildHops = 32;
// Tool chatter at a few hundred revolutions a minute rings anew with every tooth, and no line of it stands in a short
// window. But it does not repeat, so its power outgrows that of what does: over these ratios of power, for so long.
constexpr double kOverUsual = 30.0, kOverRepeating = 3.0, kUnrepeated_s = 0.15, kUnrepeatedRevolutions = 8.0;
constexpr double kRevolutionsToRepeat = 16.0;  // of constant speed and contact, until all that repeats is known
constexpr double kUsualMemory_s = 2.0, kUsualClip = 4.0;

}  // namespace

void Monitor::look_for_onset(std::size_t index, std::int64_t stamp_ns, double step_s) noexcept {
  const SensorPath& path = sensors_[index].path;
  Suspect& suspect = suspect_[index];
  view_.indicator = 0.0;
  if (gate_.state() == State::idle) {
    suspect = {};
    return;
  }
  const bool held = gate_.state() == State::entry || gate_.state() == State::exit;
  double strongest = 0.0;
  bool heard_again = false;
  for (const LineCandidate& candidate : path.watch().candidates()) {
    if (candidate.ratio < 1.0) {
      strongest = std::max(strongest, candidate.ratio);
      continue;
    }
    strongest = std::max(strongest, 0.98);  // loud, but not chatter as far as can be told
    if (held || heard_again) continue;
    const Tone tone = analyse_tone(path.watch().window(candidate.axis), path.sample_rate_hz(), candidate.frequency_hz);
    const Suspect heard = classify(path, candidate, tone);
    if (heard.line == Line::nothing) continue;
    heard_again = add_evidence(suspect, heard, tone, path.bin_hz(), stamp_ns);
    if (!heard_again || suspect.evidence < evidence_asked(path, suspect)) continue;
    if (!speed_confirmed(suspect.since_ns) || of_forced(path, tone) < kLeastOfForced) continue;
    begin_chatter(index, stamp_ns, candidate, tone);
    return;
  }
  if (!heard_again) suspect.evidence = std::max(0.0, suspect.evidence - 1.0);
  if (suspect.evidence <= 0.0) suspect.line = Line::nothing;
  view_.indicator = std::sqrt(strongest);
  if (look_for_growing_order(index, stamp_ns) || look_for_wild_chatter(index, stamp_ns)) return;
  if (look_for_unrepeated_chatter(index, stamp_ns, step_s)) return;
  look_for_standing_chatter(index, stamp_ns);
}

// Takes what was heard for the suspect if it is the same line, or if there was none. A line keeps its name while it
// moves off an order; its sidebands turn by the same in a revolution, so they count for it.
bool Monitor::add_evidence(Suspect& suspect, const Suspect& heard, const Tone& tone, double bin_hz,
                           std::int64_t stamp_ns) const noexcept {
  const bool near = std::abs(heard.frequency_hz - suspect.frequency_hz) < bin_hz;
  const bool sideband = heard.line == Line::free && suspect.line == Line::free;
  const bool same = suspect.line != Line::nothing && (near || sideband) &&
                    std::abs(std::remainder(heard.cycles - suspect.cycles, 1.0)) < kSteadyCycles;
  if (!same && suspect.evidence > 0.0) return false;
  const double peak = same && near ? suspect.peak : 0.0;
  const bool grows = tone.rise > kGrows && tone.amplitude > peak;
  const bool stands = tone.rise > kStands && tone.amplitude > kHoldsPeak * peak;
  const double evidence = suspect.evidence + (grows ? kGrowingCounts : stands ? 1.0 : 0.0);
  const std::int64_t since_ns = same ? suspect.since_ns : stamp_ns;
  suspect = heard;
  suspect.evidence = evidence;
  suspect.since_ns = since_ns;
  suspect.peak = std::max(peak, tone.amplitude);
  return true;
}

double Monitor::evidence_asked(const SensorPath& path, const Suspect& suspect) const noexcept {
  const double enough = suspect.line == Line::free ? kEnoughFree : kEnoughOnOrder;
  const bool entering = gate_.state() == State::air && path.rise() > kRiseToDoubt;
  return entering || steady_s_ < kNewCut_s || path.fall() > kFallToDoubt ? kDoubtAsks * enough : enough;
}

bool Monitor::look_for_wild_chatter(std::size_t index, std::int64_t stamp_ns) noexcept {
  const SensorPath& path = sensors_[index].path;
  const bool wild = gate_.state() == State::cut && path.watch().common() > kWild;
  wild_hops_[index] = wild ? wild_hops_[index] + 1 : 0;
  const int enough = steady_s_ < kNewCut_s ? 2 * kWildHops : kWildHops;
  if (wild_hops_[index] < enough || path.watch().candidates().empty()) return false;
  if (!begin_wild_chatter(index, stamp_ns, path.watch().candidates().front())) return false;
  wild_hops_[index] = 0;
  return true;
}

bool Monitor::look_for_unrepeated_chatter(std::size_t index, std::int64_t stamp_ns, double step_s) noexcept {
  const SensorPath& path = sensors_[index].path;
  Unrepeated& heard = unrepeated_[index];
  const double power = path.residual_level() * path.residual_level();
  const double repeated = path.synchronous_level() * path.synchronous_level();
  const bool known = gate_.state() == State::cut && steady_s_ * spindle_hz() > kRevolutionsToRepeat;
  const double over = known && power > kOverUsual * heard.usual ? power / std::max(repeated, 1e-30) : 0.0;
  if (over > kOverRepeating) heard.loud_s += step_s;
  if (over < 0.5 * kOverRepeating) heard.loud_s = std::max(0.0, heard.loud_s - 2.0 * step_s);
  const double gain = heard.usual > 0.0 ? step_s / kUsualMemory_s : 1.0;
  heard.usual += gain * ((heard.usual > 0.0 ? std::min(power, kUsualClip * heard.usual) : power) - heard.usual);
  if (heard.loud_s < std::max(kUnrepeated_s, kUnrepeatedRevolutions / spindle_hz())) return false;
  LineCandidate loudest = path.watch().loudest_near_modes();
  if (loudest.frequency_hz > 0.0) {
    loudest.ratio = path.watch().ratio_at(loudest.frequency_hz);
  } else if (!path.watch().candidates().empty()) {
    loudest = path.watch().candidates().front();
  } else {
    return false;
  }
  if (!begin_wild_chatter(index, stamp_ns, loudest)) return false;
  heard.loud_s = 0.0;
  return true;
}

// Chatter without a line of its own, told under the loudest there is; false where that moves the tool too little.
bool Monitor::begin_wild_chatter(std::size_t index, std::int64_t stamp_ns, const LineCandidate& loudest) noexcept {
  const SensorPath& path = sensors_[index].path;
  const Tone tone = analyse_tone(path.watch().window(loudest.axis), path.sample_rate_hz(), loudest.frequency_hz);
  if (of_forced(path, tone) < kLeastOfForced) return false;
  suspect_[index].line = Line::wild;
  begin_chatter(index, stamp_ns, loudest, tone);
  return true;
}

// Chatter that grew before a floor could be learned (in the first moments of a recording or of a cut) is part of that
// floor. It gives itself away by its share of the vibration: a line near a mode, not the spindle's, that holds a third
// of all energy, moves the tool half as far as the forced vibration, and stands still in phase for longer than a new
// one has to.
void Monitor::look_for_standing_chatter(std::size_t index, std::int64_t stamp_ns) noexcept {
  constexpr double kShareOfEnergy = 0.2, kOfForced = 0.4;
  constexpr int kHops = 12;
  SensorPath& path = sensors_[index].path;
  Suspect& standing = standing_[index];
  const bool held = gate_.state() != State::air && gate_.state() != State::cut;
  LineCandidate candidate = held ? LineCandidate{} : path.watch().loudest_near_modes();
  const bool loud = 0.5 * candidate.ratio * candidate.ratio > kShareOfEnergy * path.level() * path.level();
  if (!loud || !(candidate.frequency_hz > 0.0)) {
    standing = {};
    return;
  }
  candidate.ratio = 1.0;
  const Tone tone = analyse_tone(path.watch().window(candidate.axis), path.sample_rate_hz(), candidate.frequency_hz);
  Suspect heard = classify(path, candidate, tone);
  const bool same = heard.line == Line::free && std::abs(heard.frequency_hz - standing.frequency_hz) < path.bin_hz() &&
                    std::abs(std::remainder(heard.cycles - standing.cycles, 1.0)) < kSteadyCycles;
  const bool counts = heard.line == Line::free && tone.rise > kStands;
  heard.evidence = !counts ? 0.0 : same ? standing.evidence + 1.0 : 1.0;
  heard.since_ns = same ? standing.since_ns : stamp_ns;
  standing = heard;
  if (standing.evidence < kHops || !speed_confirmed(standing.since_ns) || of_forced(path, tone) < kOfForced) return;
  path.watch().expose(tone.frequency_hz);
  suspect_[index] = std::exchange(standing, {});
  begin_chatter(index, stamp_ns, candidate, tone);
}

void Monitor::begin_chatter(std::size_t index, std::int64_t stamp_ns, const LineCandidate& candidate,
                            const Tone& heard) noexcept {
  const Line line = suspect_[index].line;
  suspect_ = standing_ = {};
  wild_hops_ = {};
  const Tone tone = line == Line::free ? base_line(sensors_[index].path, candidate.axis, heard) : heard;
  if (gate_.contact() == CutGate::Change::entered) {
    emit(stamp_ns, EventType::cut_entry, ChatterKind::unknown, kNaN, "told by chatter");
  }
  view_.chatter = true;
  view_.kind = line == Line::free ? name_kind(tone.frequency_hz) : ChatterKind::unknown;
  view_.chatter_frequency_hz = heard_hz_ = tone.frequency_hz;
  hops_heard_ = 1;
  view_.chatter_amplitude = tone.amplitude;
  view_.indicator = std::sqrt(candidate.ratio);
  chatter_sensor_ = index;
  smooth_ratio_ = candidate.ratio;
  below_s_ = doubt_s_ = unseen_s_ = 0.0;
  free_hops_ = order_hops_ = 0;
  was_free_ = line == Line::free;
  view_.single_line = line != Line::wild;
  largest_amplitude_ = tone.amplitude;
  largest_order_ratio_ = 0.0;
  faded_ = false;
  // Back along the measured growth to where the line left its floor (S = 1).
  const double log_amplitude = 0.5 * std::log(std::max(1.0, candidate.ratio * settings_.watch.limit));
  const double since_s = tone.growth_per_s > 1.0 ? std::min(1.0, log_amplitude / tone.growth_per_s) : 0.0;
  const char* const about = line == Line::on_order ? " on a spindle order: a speed 1-2 % off would tell"
                            : line == Line::wild   ? " no single line: the tool is thrown about"
                                                   : "";
  char note[96];
  std::snprintf(note, sizeof note, "start=%.3f%s",
                std::max(0.0, static_cast<double>(stamp_ns - origin_ns_) * 1e-9 - since_s), about);
  emit(stamp_ns, EventType::chatter_onset, view_.kind, view_.chatter_frequency_hz, note);
}

}  // namespace stillcut
