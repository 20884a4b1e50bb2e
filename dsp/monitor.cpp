#include "dsp/monitor.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <stdexcept>

namespace stillcut {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kBlindToEnd_s = 0.5;           // chatter out of sight for this long is over as far as can be told
constexpr double kFilterRevolutions = 16.0;     // memory of the synchronous filter
constexpr double kLongestFilterMemory_s = 0.25;
constexpr double kFilterSlowdown = 8.0;         // in chatter, so that it is not learned as synchronous

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
  view_.speed = settings_.has_speed_signal ? std::max(0.0, speed_.at(placed.stamp_ns)) : settings_.nominal_speed;
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
  if (!able && !view_.chatter) view_.indicator = kNaN;
  const bool idle = gate_.state() == State::idle;
  view_.state = !trusted ? State::cannot_tell
                : view_.chatter ? State::chatter
                : able || idle ? gate_.state()
                               : State::cannot_tell;
}

void Monitor::look_for_onset(std::size_t index, std::int64_t stamp_ns) noexcept {
  SensorPath& path = sensors_[index].path;
  const LineWatch& watch = path.watch();
  double strongest = 0.0;
  view_.indicator = 0.0;
  if (gate_.state() == State::idle) return;
  for (const LineCandidate& candidate : watch.candidates()) {
    double ratio = candidate.ratio;
    if (ratio < 1.0) {
      strongest = std::max(strongest, ratio);
      continue;
    }
    const Tone tone = analyse_tone(watch.window(candidate.axis), path.sample_rate_hz(), candidate.frequency_hz);
    const Line line = classify(path, candidate, tone);
    const bool held = gate_.state() == State::entry || gate_.state() == State::exit;
    if (line == Line::nothing || held) {
      strongest = std::max(strongest, 0.98);  // loud, but not chatter as far as can be told
      continue;
    }
    if (gate_.contact() == CutGate::Change::entered) {
      emit(stamp_ns, EventType::cut_entry, ChatterKind::unknown, kNaN, "told by chatter");
    }
    view_.chatter = true;
    view_.kind = line == Line::on_order ? ChatterKind::unknown : name_kind(tone.frequency_hz);
    view_.chatter_frequency_hz = tone.frequency_hz;
    view_.chatter_amplitude = tone.amplitude;
    view_.indicator = std::sqrt(ratio);
    chatter_sensor_ = index;
    below_s_ = doubt_s_ = 0.0;
    free_hops_ = 0;
    // Back along the measured growth to where the line left its floor (S = 1).
    const double decades = 0.5 * std::log(std::max(1.0, ratio * settings_.watch.limit));
    const double since_s = tone.growth_per_s > 1.0 ? std::min(1.0, decades / tone.growth_per_s) : 0.0;
    char note[96];
    std::snprintf(note, sizeof note, "start=%.3f%s", static_cast<double>(stamp_ns - origin_ns_) * 1e-9 - since_s,
                  line == Line::on_order ? " on a spindle order, not told apart yet" : "");
    emit(stamp_ns, EventType::chatter_onset, view_.kind, view_.chatter_frequency_hz, note);
    return;
  }
  view_.indicator = std::sqrt(strongest);
}

Monitor::Line Monitor::classify(const SensorPath& path, const LineCandidate& candidate, const Tone& tone) const noexcept {
  // Chatter grows or stands. What fades is a knock; what fills only the last quarter of the window has just begun.
  if (tone.rise < 0.8 || tone.steadiness < 0.15) return Line::nothing;
  const double frequency_hz = tone.frequency_hz;
  if (std::abs(frequency_hz - candidate.frequency_hz) > 1.5 * path.sample_rate_hz() / path.watch().window_length()) {
    return Line::nothing;
  }
  if (away_from_order(frequency_hz) > std::max(4.0, 0.001 * frequency_hz)) return Line::free;
  // On a spindle order a line may be forced. It counts only if it grows at constant speed while the other orders do not.
  const double spindle_hz = view_.speed / (2.0 * std::numbers::pi);
  const double settled_s = std::max(0.3, 2.0 * kFilterRevolutions / std::max(spindle_hz, 1.0));
  if (tone.growth_per_s <= 0.0 || steady_s_ < settled_s || spindle_hz <= 0.0) return Line::nothing;
  const auto own = std::lround(frequency_hz / spindle_hz);
  double others = 0.0;
  for (long order = 1; order * spindle_hz < 0.4 * path.sample_rate_hz(); ++order) {
    if (std::abs(order - own) * spindle_hz < 2.5 * path.sample_rate_hz() / path.watch().window_length()) continue;
    others = std::max(others, path.watch().ratio_at(order * spindle_hz));
  }
  return candidate.ratio > 4.0 * others ? Line::on_order : Line::nothing;
}

void Monitor::follow_chatter(std::int64_t stamp_ns, double step_s) noexcept {
  const SensorPath& path = sensors_[chatter_sensor_].path;
  const LineWatch& watch = path.watch();
  const double bin_hz = path.sample_rate_hz() / watch.window_length();
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
      emit(stamp_ns, EventType::chatter_onset, kind, view_.chatter_frequency_hz, "kind now told: off the spindle order");
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

double Monitor::away_from_order(double frequency_hz) const noexcept {
  const double spindle_hz = view_.speed / (2.0 * std::numbers::pi);
  return spindle_hz > 0.0 ? std::abs(std::remainder(frequency_hz, spindle_hz)) : frequency_hz;
}

ChatterKind Monitor::name_kind(double frequency_hz) const noexcept {
  // Regenerative chatter stands near a mode of the structure (above it by tenths); far from all of them no name is given.
  bool near = mode_count_ == 0;
  for (std::size_t m = 0; m < mode_count_; ++m) {
    near = near || std::abs(frequency_hz - modes_[m].frequency_hz) < 0.2 * modes_[m].frequency_hz;
  }
  return near ? ChatterKind::regenerative : ChatterKind::unknown;
}

}  // namespace stillcut
