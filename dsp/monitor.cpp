#include "dsp/monitor.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <utility>

namespace stillcut {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kBlindToEnd_s = 0.5;        // chatter out of sight for this long is over as far as can be told
constexpr double kFilterRevolutions = 16.0;  // memory of the synchronous filter
constexpr double kLongestFilterMemory_s = 0.25;
constexpr int kHopsFree = 3, kHopsOnOrder = 4;  // a suspect must be the same for so many hops
constexpr double kSteadyCycles = 0.12;          // and keep its phase against the revolution before
constexpr double kFrequencyDoubt_hz = 3.0;      // closer to an order a line is on it, as far as can be told
constexpr std::int64_t kLongestSuspense_ns = 60'000'000;
constexpr double kFilterSlowdown = 8.0;  // in chatter, so that it is not learned as synchronous

}  // namespace

Monitor::Monitor(const MonitorSettings& settings) : settings_{settings}, gate_{settings.gate} {
  if (settings.sensors.empty() || settings.sensors.size() > kMaxSensors) {
    throw std::invalid_argument("a monitor needs one to four accelerometers");
  }
  for (const SensorSettings& sensor : settings.sensors) {
    if (!(sensor.sample_rate_hz >= 500.0) || (sensor.axes_present & 7U) == 0) {
      throw std::invalid_argument("an accelerometer needs a sample rate of at least 500 Hz and one axis");
    }
    sensors_.push_back({SampleClock{sensor.sample_rate_hz}, SensorPath{sensor, settings.watch}, 0, 0, 0, false});
  }
  view_.chatter_frequency_hz = kNaN;
  view_.state = State::cannot_tell;
}

void Monitor::add_speed(const SpindleReading& reading) noexcept {
  const bool plausible = std::isfinite(reading.speed) && reading.speed >= 0.0 &&
                         (settings_.highest_speed <= 0.0 || reading.speed <= 1.5 * settings_.highest_speed);
  speed_fault_ = plausible ? kNoDoubt : kSpeedImplausible;
  if (!plausible) return;
  if (std::abs(reading.speed - speed_.last_speed()) > 0.002 * reading.speed) steady_s_ = 0.0;
  speed_.add(reading);
}

void Monitor::expect(std::span<const ExpectedMode> modes, double margin) noexcept {
  mode_count_ = std::min(modes.size(), kMaxModes);
  std::copy_n(modes.begin(), mode_count_, modes_.begin());
  for (Sensor& sensor : sensors_) sensor.path.watch().set_prior(modes.first(mode_count_), margin);
}

void Monitor::add_samples(const SampleBlock& block) noexcept {
  if (block.sensor >= sensors_.size() || block.samples == 0) return;
  Sensor& sensor = sensors_[block.sensor];
  const SampleClock::Placed placed = sensor.clock.place(block.stamp_ns, block.samples, block.frames_lost);
  if (first_sample_ns_ == 0) first_sample_ns_ = placed.stamp_ns;
  sensor.last_arrival_ns = block.stamp_ns;
  sensor.heard = true;
  view_.speed = speed_at(placed.stamp_ns);
  if (placed.samples_lost > 0) {
    sensor.path.skip(placed.samples_lost, view_.speed);
    report_lost_frames(sensor, placed.samples_lost, placed.stamp_ns);
  }
  const double rate = sensor.path.sample_rate_hz();
  const double revolution_s = view_.speed > 0.0 ? 2.0 * std::numbers::pi / view_.speed : 1.0;
  const double memory = std::clamp(kLongestFilterMemory_s / revolution_s, 6.0, kFilterRevolutions);
  const bool loud = view_.chatter && view_.indicator > 1.0;
  sensor.path.filter().set_memory(loud ? kFilterSlowdown * memory : memory);
  for (int i = 0; i < block.samples;) {
    i = sensor.path.process(block, i, view_.speed);
    if (!sensor.path.hop_complete()) break;
    const auto stamp_ns = placed.stamp_ns - std::llround((block.samples - i) * 1e9 / rate);
    finish_hop(block.sensor, stamp_ns, sensor.path.watch().hop_length() / rate);
  }
}

void Monitor::finish_hop(std::size_t index, std::int64_t stamp_ns, double step_s) noexcept {
  Sensor& sensor = sensors_[index];
  view_.stamp_ns = newest_ns_ = std::max(newest_ns_, stamp_ns);
  steady_s_ += step_s;
  update_speed_doubts(stamp_ns, step_s);
  update_silence(stamp_ns, step_s);
  set_doubts(kGap | kSaturated | kStuck | kNotFinite, sensor.path.doubts(), stamp_ns, step_s);

  if (index == 0) {  // one gate for the cell, driven by the first accelerometer's hops
    double power = 0.0;
    for (const Sensor& each : sensors_) power += each.path.level() * each.path.level();
    const CutGate::Change change = gate_.step(std::sqrt(power), view_.speed, step_s);
    if (change != CutGate::Change::none) steady_s_ = 0.0;
    if (change == CutGate::Change::entered) {
      for (Sensor& each : sensors_) {
        each.path.filter().restart();
        each.path.watch().relearn_floor();
      }
      emit(stamp_ns, EventType::cut_entry, ChatterKind::unknown, kNaN, "");
    } else if (change == CutGate::Change::left) {
      if (view_.chatter) end_chatter(stamp_ns, "cut exit");
      for (Sensor& each : sensors_) each.path.filter().restart();
      emit(stamp_ns, EventType::cut_exit, ChatterKind::unknown, kNaN, "");
    }
  }

  const bool trusted = view_.doubts == kNoDoubt;
  const bool able = trusted && sensor.path.watch().ready();
  if (view_.chatter && !trusted) {
    doubt_s_ += step_s;
    if (doubt_s_ > kBlindToEnd_s) end_chatter(stamp_ns, "cannot tell any longer");
  } else if (view_.chatter) {
    doubt_s_ = 0.0;
    if (index == chatter_sensor_) follow_chatter(stamp_ns, step_s);
  } else if (able) {
    look_for_onset(index, stamp_ns);
  }
  for (Sensor& each : sensors_) each.path.watch().hold_floor(view_.chatter || !trusted);
  if (!able) view_.indicator = kNaN;
  const bool idle = gate_.state() == State::idle;
  view_.state = !trusted        ? State::cannot_tell
                : view_.chatter ? State::chatter
                : able || idle  ? gate_.state()
                                : State::cannot_tell;
}

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
  below_s_ = doubt_s_ = 0.0;
  free_hops_ = 0;
  // Back along the measured growth to where the line left its floor (S = 1).
  const double log_amplitude = 0.5 * std::log(std::max(1.0, candidate.ratio * settings_.watch.limit));
  const double since_s = tone.growth_per_s > 1.0 ? std::min(1.0, log_amplitude / tone.growth_per_s) : 0.0;
  char note[96];
  std::snprintf(note, sizeof note, "start=%.3f%s", static_cast<double>(stamp_ns - origin_ns_) * 1e-9 - since_s,
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
  if (steady_s_ < std::max(0.3, 2.0 * kFilterRevolutions / spindle_hz)) return false;
  const double own_hz = std::round(candidate.frequency_hz / spindle_hz) * spindle_hz;
  double others = 0.0;
  for (double hz = spindle_hz; hz < 0.4 * path.sample_rate_hz(); hz += spindle_hz) {
    if (std::abs(hz - own_hz) >= 2.5 * path.bin_hz()) others = std::max(others, path.watch().ratio_at(hz));
  }
  return candidate.ratio > 4.0 * others;
}

void Monitor::follow_chatter(std::int64_t stamp_ns, double step_s) noexcept {
  const SensorPath& path = sensors_[chatter_sensor_].path;
  const LineWatch& watch = path.watch();
  const double bin_hz = path.bin_hz();
  double ratio = watch.ratio_at(view_.chatter_frequency_hz);
  for (const LineCandidate& candidate : watch.candidates()) {
    if (std::abs(candidate.frequency_hz - view_.chatter_frequency_hz) > 1.5 * bin_hz) continue;
    const Tone tone = analyse_tone(watch.window(candidate.axis), path.sample_rate_hz(), candidate.frequency_hz);
    if (candidate.ratio < 1.0 || std::abs(tone.frequency_hz - candidate.frequency_hz) > 1.5 * bin_hz) break;
    ratio = std::max(ratio, candidate.ratio);
    view_.chatter_frequency_hz = tone.frequency_hz;
    view_.chatter_amplitude = tone.amplitude;
    free_hops_ = away_from_order(tone.frequency_hz) > std::max(5.0, 0.001 * tone.frequency_hz) ? free_hops_ + 1 : 0;
    break;
  }
  view_.indicator = std::sqrt(ratio);
  if (view_.kind == ChatterKind::unknown && free_hops_ >= 2) {
    const ChatterKind kind = name_kind(view_.chatter_frequency_hz);
    if (kind != ChatterKind::unknown) {
      view_.kind = kind;
      emit(stamp_ns, EventType::chatter_onset, kind, view_.chatter_frequency_hz,
           "kind now told: off the spindle order");
    }
  }
  below_s_ = ratio < settings_.release_ratio ? below_s_ + step_s : 0.0;
  if (below_s_ >= settings_.release_s) end_chatter(stamp_ns, "");
}

void Monitor::end_chatter(std::int64_t stamp_ns, const char* why) noexcept {
  emit(stamp_ns, EventType::chatter_end, view_.kind, view_.chatter_frequency_hz, why);
  view_.chatter = false;
  view_.kind = ChatterKind::unknown;
  view_.chatter_frequency_hz = kNaN;
  view_.chatter_amplitude = 0.0;
  steady_s_ = 0.0;
}

double Monitor::speed_at(std::int64_t stamp_ns) const noexcept {
  return settings_.has_speed_signal ? std::max(0.0, speed_.at(stamp_ns)) : settings_.nominal_speed;
}

double Monitor::speed_uncertainty() const noexcept { return settings_.has_speed_signal ? speed_.uncertainty() : 0.0; }

double Monitor::away_from_order(double frequency_hz) const noexcept {
  const double spindle_hz = view_.speed / (2.0 * std::numbers::pi);
  return spindle_hz > 0.0 ? std::abs(std::remainder(frequency_hz, spindle_hz)) : frequency_hz;
}

ChatterKind Monitor::name_kind(double frequency_hz) const noexcept {
  // Regenerative chatter stands near a mode of the structure (above it by tenths); far from all of them no name is
  // given.
  bool near = mode_count_ == 0;
  for (std::size_t m = 0; m < mode_count_; ++m) {
    near = near || std::abs(frequency_hz - modes_[m].frequency_hz) < 0.2 * modes_[m].frequency_hz;
  }
  return near ? ChatterKind::regenerative : ChatterKind::unknown;
}

}  // namespace stillcut
