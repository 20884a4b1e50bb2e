// How the monitor comes to call a line chatter: it must stand, keep its phase from hop to hop, and not belong to the
// spindle.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <utility>

#include "dsp/monitor.hpp"
#include "dsp/numbers.hpp"

namespace stillcut {
namespace {

constexpr int kHopsFree = 3, kHopsOnOrder = 4;  // a suspect must be the same for so many hops
constexpr double kSteadyCycles = 0.12;          // and keep its phase against the revolution before
constexpr double kFrequencyDoubt_hz = 3.0;      // closer to an order a line is on it, as far as can be told
constexpr double kSettledRevolutions = 32.0;    // of constant speed and contact before a line on an order may count
constexpr std::int64_t kLongestSuspense_ns = 60'000'000;

}  // namespace

void Monitor::look_for_onset(std::size_t index, std::int64_t stamp_ns) noexcept {
  SensorPath& path = sensors_[index].path;
  const LineWatch& watch = path.watch();
  Suspect& suspect = suspect_[index];
  view_.indicator = 0.0;
  if (gate_.state() == State::idle) {
    suspect = {};
    return;
  }
  const bool held = gate_.state() == State::entry || gate_.state() == State::exit;
  double strongest = 0.0;
  bool heard_again = false;
  for (const LineCandidate& candidate : watch.candidates()) {
    if (candidate.ratio < 1.0) {
      strongest = std::max(strongest, candidate.ratio);
      continue;
    }
    strongest = std::max(strongest, 0.98);  // loud, but not chatter as far as can be told
    const Tone tone = analyse_tone(watch.window(candidate.axis), path.sample_rate_hz(), candidate.frequency_hz);
    Suspect heard = classify(path, candidate, tone);
    if (heard.line == Line::nothing || held) continue;
    const bool same = suspect.line == heard.line &&
                      std::abs(heard.frequency_hz - suspect.frequency_hz) < path.bin_hz() &&
                      std::abs(std::remainder(heard.cycles - suspect.cycles, 1.0)) < kSteadyCycles;
    if (!same && suspect.hops > 0) continue;
    heard.hops = suspect.hops + 1;
    heard.since_ns = same ? suspect.since_ns : stamp_ns;
    suspect = heard;
    heard_again = true;
    if (heard.hops >= (heard.line == Line::free ? kHopsFree : kHopsOnOrder) && speed_confirmed(heard.since_ns)) {
      begin_chatter(index, stamp_ns, candidate, tone);
      return;
    }
    break;
  }
  if (!heard_again && suspect.hops > 0) --suspect.hops;
  if (suspect.hops == 0) suspect.line = Line::nothing;
  view_.indicator = std::sqrt(strongest);
  look_for_standing_chatter(index, stamp_ns);
}

// Chatter that grew before a floor could be learned (in the first moments of a recording or of a cut) is part of that
// floor. It gives itself away by its share of the vibration: a line near a mode, not the spindle's, that holds a tenth
// of all energy and stands still in phase for longer than a new one has to.
void Monitor::look_for_standing_chatter(std::size_t index, std::int64_t stamp_ns) noexcept {
  constexpr double kShareOfEnergy = 0.1;
  constexpr int kHops = 12;
  SensorPath& path = sensors_[index].path;
  Suspect& standing = standing_[index];
  LineCandidate candidate = path.watch().loudest_near_modes();
  const bool loud = 0.5 * candidate.ratio * candidate.ratio > kShareOfEnergy * path.level() * path.level();
  const bool held = gate_.state() != State::air && gate_.state() != State::cut;
  if (!loud || held || !(candidate.frequency_hz > 0.0)) {
    standing = {};
    return;
  }
  candidate.ratio = 1.0;
  const Tone tone = analyse_tone(path.watch().window(candidate.axis), path.sample_rate_hz(), candidate.frequency_hz);
  Suspect heard = classify(path, candidate, tone);
  const bool same = heard.line == Line::free && std::abs(heard.frequency_hz - standing.frequency_hz) < path.bin_hz() &&
                    std::abs(std::remainder(heard.cycles - standing.cycles, 1.0)) < kSteadyCycles;
  heard.hops = heard.line != Line::free ? 0 : same ? standing.hops + 1 : 1;
  heard.since_ns = same ? standing.since_ns : stamp_ns;
  standing = heard;
  if (standing.hops < kHops || !speed_confirmed(standing.since_ns)) return;
  path.watch().expose(tone.frequency_hz);
  suspect_[index] = std::exchange(standing, {});
  begin_chatter(index, stamp_ns, candidate, tone);
}

void Monitor::begin_chatter(std::size_t index, std::int64_t stamp_ns, const LineCandidate& candidate,
                            const Tone& tone) noexcept {
  const Line line = std::exchange(suspect_[index], {}).line;
  if (gate_.contact() == CutGate::Change::entered) {
    emit(stamp_ns, EventType::cut_entry, ChatterKind::unknown, kNaN, "told by chatter");
  }
  view_.chatter = true;
  view_.kind = line == Line::on_order ? ChatterKind::unknown : name_kind(tone.frequency_hz);
  view_.chatter_frequency_hz = tone.frequency_hz;
  view_.chatter_amplitude = tone.amplitude;
  view_.indicator = std::sqrt(candidate.ratio);
  chatter_sensor_ = index;
  below_s_ = doubt_s_ = unseen_s_ = 0.0;
  free_hops_ = order_hops_ = 0;
  was_free_ = line != Line::on_order;
  largest_amplitude_ = tone.amplitude;
  faded_ = false;
  // Back along the measured growth to where the line left its floor (S = 1).
  const double log_amplitude = 0.5 * std::log(std::max(1.0, candidate.ratio * settings_.watch.limit));
  const double since_s = tone.growth_per_s > 1.0 ? std::min(1.0, log_amplitude / tone.growth_per_s) : 0.0;
  char note[96];
  std::snprintf(note, sizeof note, "start=%.3f%s",
                std::max(0.0, static_cast<double>(stamp_ns - origin_ns_) * 1e-9 - since_s),
                line == Line::on_order ? " on a spindle order, not told apart yet" : "");
  emit(stamp_ns, EventType::chatter_onset, view_.kind, view_.chatter_frequency_hz, note);
}

// A line that moves against the orders may be the spindle that changes its speed: a reading since then must say no.
bool Monitor::speed_confirmed(std::int64_t since_ns) const noexcept {
  return !settings_.has_speed_signal || speed_.last_stamp_ns() >= since_ns ||
         newest_ns_ - since_ns > kLongestSuspense_ns;
}

// Whatever comes from the spindle repeats after a revolution, also where several orders run together in one window, and
// also while the filter has yet to learn it. Chatter between the orders does not: its phase turns.
Monitor::Suspect Monitor::classify(const SensorPath& path, const LineCandidate& candidate,
                                   const Tone& tone) const noexcept {
  Suspect suspect;
  suspect.frequency_hz = tone.frequency_hz;
  // Chatter grows or stands. What fades is a knock; what fills only the last quarter of the window has just begun.
  if (tone.rise < 0.8 || tone.steadiness < 0.15) return suspect;
  if (std::abs(tone.frequency_hz - candidate.frequency_hz) > 1.5 * path.bin_hz()) return suspect;
  const LineWatch& watch = path.watch();
  const auto window_ns = std::llround(1e9 / path.bin_hz());
  const auto revolution_ns = [](double speed) { return std::llround(2e9 * std::numbers::pi / speed); };
  double speed = speed_at(newest_ns_ - window_ns / 2);
  if (speed < settings_.gate.idle_speed) return suspect;
  speed = speed_at(newest_ns_ - (window_ns + revolution_ns(speed)) / 2);
  if (speed < settings_.gate.idle_speed) return suspect;
  const double spindle_hz = speed / (2.0 * std::numbers::pi);
  const double orders = tone.frequency_hz / spindle_hz;
  const double speed_error = 2.0 * orders * speed_uncertainty() / speed;  // in cycles of the line
  double allowed = kFrequencyDoubt_hz / spindle_hz + speed_error;
  if (revolution_ns(speed) < watch.longest_lag_s() * 1e9) {
    const double noise = 0.25 / std::sqrt(std::max(1.0, candidate.ratio * settings_.watch.limit));
    const Recurrence turned = recurrence(watch.kept(candidate.axis), watch.window_length(), path.sample_rate_hz(),
                                         tone.frequency_hz, 1.0 / spindle_hz);
    suspect.cycles = turned.cycles;
    allowed += noise;
    if (turned.before < 0.25 || std::abs(std::remainder(orders - turned.cycles, 1.0)) > 0.1 + noise + speed_error) {
      return suspect;
    }
  } else {  // a slow spindle: more than is kept of the past
    suspect.cycles = std::remainder(orders, 1.0);
  }
  if (std::abs(suspect.cycles) > allowed) {
    suspect.line = Line::free;
  } else if (tone.growth_per_s > 0.0 && stands_out_of_the_orders(path, candidate, spindle_hz)) {
    suspect.line = Line::on_order;
  }
  return suspect;
}

// On a spindle order a line may be forced. It counts only if it grows at constant speed while the other orders do not.
bool Monitor::stands_out_of_the_orders(const SensorPath& path, const LineCandidate& candidate,
                                       double spindle_hz) const noexcept {
  if (steady_s_ < std::max(0.3, kSettledRevolutions / spindle_hz)) return false;
  const double own_hz = std::round(candidate.frequency_hz / spindle_hz) * spindle_hz;
  double others = 0.0;
  const auto orders = static_cast<int>(0.4 * path.sample_rate_hz() / spindle_hz);
  for (int order = 1; order <= orders; ++order) {
    const double hz = order * spindle_hz;
    if (std::abs(hz - own_hz) >= 2.5 * path.bin_hz()) others = std::max(others, path.watch().ratio_at(hz));
  }
  return candidate.ratio > 4.0 * others;
}

}  // namespace stillcut
