#include "dsp/monitor.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "dsp/numbers.hpp"

namespace stillcut {
namespace {

constexpr double kLargestStep_hz = 5.0;  // from hop to hop of a chatter line
constexpr double kOutOfSight_s = 0.06;
constexpr double kBlindToEnd_s = 0.5;  // chatter out of sight for this long is over as far as can be told
// Memory of the synchronous filter: short, so that a change of depth has left the residual after a few revolutions, and
// chatter is not hidden behind it; a line 0.05 of an order off the spindle's passes all the same.
constexpr double kFilterRevolutions = 4.0;
constexpr int kHopsToBelong = 16;           // half a release time
constexpr double kSameMode = 0.01;          // by which a mode's frequency may drift before it is another
constexpr double kFadedOrder = 0.1;         // of the largest power
constexpr double kFaded = 0.1;              // of the largest amplitude of the episode
constexpr int kFrequencyHops = 8;           // of the running mean of its frequency
constexpr double kReleaseSmoothing = 0.25;  // a hop
constexpr double kFilterSlowdown = 8.0;     // in chatter, so that it is not learned as synchronous

}  // namespace

Monitor::Monitor(const MonitorSettings& settings) : settings_{settings}, gate_{settings.gate} {
  if (settings.sensors.empty() || settings.sensors.size() > kMaxSensors) {
    throw std::invalid_argument("a monitor needs one to four accelerometers");
  }
  for (const SensorSettings& sensor : settings.sensors) {
    if (!(sensor.sample_rate_hz >= 500.0) || (sensor.axes_present & 7U) == 0) {
      throw std::invalid_argument("an accelerometer needs a sample rate of at least 500 Hz and one axis");
    }
    SensorPath path{sensor, settings.watch};
    const OrderWatch orders{path.axes()};
    const DecayWatch decay{path.axes()};
    sensors_.push_back({SampleClock{sensor.sample_rate_hz}, std::move(path), orders, decay});
  }
  view_.indicator = view_.chatter_frequency_hz = view_.structural_frequency_hz = kNaN;
  view_.decay_per_s = view_.decay_frequency_hz = kNaN;
  view_.state = State::cannot_tell;
}

void Monitor::add_speed(const SpindleReading& reading) noexcept {
  const bool plausible = std::isfinite(reading.speed) && reading.speed >= 0.0 &&
                         (settings_.highest_speed <= 0.0 || reading.speed <= 1.5 * settings_.highest_speed);
  speed_fault_ = plausible ? kNoDoubt : kSpeedImplausible;
  if (!plausible) return;
  // Against where it was when it was last called steady: a spindle that creeps to its target is not.
  if (std::abs(reading.speed - steady_speed_) > 0.002 * reading.speed) {
    steady_s_ = 0.0;
    steady_speed_ = reading.speed;
  }
  speed_.add(reading);
}

void Monitor::expect(std::span<const ExpectedMode> modes, double margin) noexcept {
  const std::size_t count = std::min(modes.size(), kMaxModes);
  const bool same = std::equal(modes.begin(), modes.begin() + static_cast<std::ptrdiff_t>(count), modes_.begin(),
                               modes_.begin() + static_cast<std::ptrdiff_t>(mode_count_),
                               [](const ExpectedMode& a, const ExpectedMode& b) {
                                 return std::abs(a.frequency_hz - b.frequency_hz) < kSameMode * b.frequency_hz;
                               });
  if (!same) {  // the watches of single modes begin anew
    mode_count_ = count;
    std::copy_n(modes.begin(), count, modes_.begin());
    for (Sensor& sensor : sensors_) {
      sensor.decay.forget();
      if (!view_.chatter) sensor.orders.forget();
    }
  }
  for (Sensor& sensor : sensors_) sensor.path.watch().set_prior(modes.first(count), margin);
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
  const bool loud = view_.chatter && view_.indicator > 1.0 && !faded_;
  sensor.path.filter().set_memory(loud ? kFilterSlowdown * kFilterRevolutions : kFilterRevolutions);
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
  if (index == 0) steady_s_ += step_s;
  update_speed_doubts(stamp_ns, step_s);
  update_silence(stamp_ns, step_s);
  set_doubts(kGap | kSaturated | kStuck | kNotFinite, sensor.path.doubts(), stamp_ns, step_s);

  if (index == 0) {  // one gate for the cell, driven by the first accelerometer's hops
    double whole = 0.0, synchronous = 0.0;
    for (const Sensor& each : sensors_) {
      whole += each.path.level() * each.path.level();
      synchronous += each.path.synchronous_level() * each.path.synchronous_level();
    }
    const CutGate::Change change = gate_.step(std::sqrt(synchronous), std::sqrt(whole), view_.speed, step_s);
    if (change != CutGate::Change::none) steady_s_ = 0.0;
    if (change == CutGate::Change::entered) {
      for (Sensor& each : sensors_) {
        each.path.filter().restart();
        each.path.watch().relearn_floor();
        each.path.slow().relearn_floor();
      }
      emit(stamp_ns, EventType::cut_entry, ChatterKind::unknown, kNaN, "");
    } else if (change == CutGate::Change::left) {
      if (view_.chatter) end_chatter(stamp_ns, "cut exit");
      if (view_.structural) end_structural(stamp_ns, "cut exit");
      leave_cut(stamp_ns);
    }
  }

  const bool trusted = view_.doubts == kNoDoubt;
  const bool able = trusted && sensor.path.watch().ready();
  follow_orders(index, trusted);
  follow_decay(index, able);
  if (trusted) look_for_forced_vibration(index, stamp_ns, step_s);
  if (view_.chatter && !trusted) {
    doubt_s_ += step_s;
    if (doubt_s_ > kBlindToEnd_s) end_chatter(stamp_ns, "cannot tell any longer");
  } else if (view_.chatter) {
    doubt_s_ = 0.0;
    if (index == chatter_sensor_) follow_chatter(stamp_ns, step_s);
  } else if (able) {
    look_for_onset(index, stamp_ns, step_s);
  }
  if (sensor.path.take_slow_step()) listen_to_structure(index, stamp_ns, trusted);
  for (Sensor& each : sensors_) {
    each.path.watch().hold_floor(view_.chatter || !trusted);
    each.path.slow().hold_floor(view_.structural || !trusted);
  }
  if (!able) view_.indicator = kNaN;
  const bool idle = gate_.state() == State::idle;
  view_.state = !trusted                            ? State::cannot_tell
                : view_.chatter || view_.structural ? State::chatter
                : able || idle                      ? gate_.state()
                                                    : State::cannot_tell;
}

void Monitor::follow_chatter(std::int64_t stamp_ns, double step_s) noexcept {
  const SensorPath& path = sensors_[chatter_sensor_].path;
  const LineWatch& watch = path.watch();
  const double bin_hz = path.bin_hz();
  double ratio = watch.ratio_at(heard_hz_);
  // Of the order that it stands on; NaN where none is followed.
  const bool on_order = !was_free_ && view_.single_line;
  const double of_order =
      on_order ? sensors_[chatter_sensor_].orders.ratio_at(heard_hz_) / settings_.watch.limit : kNaN;
  largest_order_ratio_ = std::fmax(largest_order_ratio_, of_order);
  const bool order_faded = of_order < kFadedOrder * largest_order_ratio_;
  if (!order_faded) ratio = std::fmax(ratio, of_order);
  // The line wanders, but it does not leap: a peak further off is another one, unless this one was out of sight.
  unseen_s_ += step_s;
  const double reach_hz = unseen_s_ > kOutOfSight_s ? 1.5 * bin_hz : kLargestStep_hz;
  for (const LineCandidate& candidate : watch.candidates()) {
    if (candidate.ratio < 1.0 || std::abs(candidate.frequency_hz - heard_hz_) > 1.5 * bin_hz) continue;
    const Tone tone = analyse_tone(watch.window(candidate.axis), path.sample_rate_hz(), candidate.frequency_hz);
    if (std::abs(tone.frequency_hz - candidate.frequency_hz) > 1.5 * bin_hz) continue;
    if (std::abs(tone.frequency_hz - heard_hz_) > reach_hz) continue;
    unseen_s_ = 0.0;
    ratio = std::max(ratio, candidate.ratio);
    heard_hz_ = tone.frequency_hz;
    ++hops_heard_;
    const double gain = 1.0 / std::min(hops_heard_, kFrequencyHops);
    view_.chatter_frequency_hz += gain * (heard_hz_ - view_.chatter_frequency_hz);
    view_.chatter_amplitude = tone.amplitude;
    const double away_hz = away_from_order(tone.frequency_hz);
    free_hops_ = away_hz > std::max(5.0, 0.001 * tone.frequency_hz) ? free_hops_ + 1 : 0;
    order_hops_ = away_hz < kOnOrder_hz ? order_hops_ + 1 : 0;
    was_free_ = was_free_ || free_hops_ >= 2;
    break;
  }
  // A correction moves the spindle until one of its orders stands where the chatter was. When the line that was free
  // has become that order and stays it, what is heard is forced vibration.
  if (was_free_ && order_hops_ >= kHopsToBelong) ratio = 0.0;
  view_.indicator = std::sqrt(ratio);
  // What the synchronous filter has learned of loud chatter it repeats on the orders when that is gone: learn afresh.
  largest_amplitude_ = std::max(largest_amplitude_, view_.chatter_amplitude);
  const bool faded = order_faded || view_.chatter_amplitude < kFaded * largest_amplitude_;
  if (faded && !faded_) {
    for (Sensor& each : sensors_) each.path.filter().restart();
  }
  faded_ = faded;
  if (view_.kind == ChatterKind::unknown && view_.single_line && free_hops_ >= 2) {
    const ChatterKind kind = name_kind(view_.chatter_frequency_hz);
    if (kind != ChatterKind::unknown) {
      view_.kind = kind;
      emit(stamp_ns, EventType::chatter_onset, kind, view_.chatter_frequency_hz,
           "kind now told: off the spindle order");
    }
  }
  smooth_ratio_ += kReleaseSmoothing * (ratio - smooth_ratio_);
  below_s_ = smooth_ratio_ < settings_.release_ratio ? below_s_ + step_s : 0.0;
  if (below_s_ >= settings_.release_s) end_chatter(stamp_ns, "");
}

void Monitor::end_chatter(std::int64_t stamp_ns, const char* why) noexcept {
  emit(stamp_ns, EventType::chatter_end, view_.kind, view_.chatter_frequency_hz, why);
  view_.chatter = false;
  view_.kind = ChatterKind::unknown;
  view_.chatter_frequency_hz = kNaN;
  view_.chatter_amplitude = 0.0;
  steady_s_ = 0.0;
  if (gate_.contact_over() == CutGate::Change::left) leave_cut(stamp_ns);
}

void Monitor::leave_cut(std::int64_t stamp_ns) noexcept {
  for (Sensor& each : sensors_) each.path.filter().forget();
  emit(stamp_ns, EventType::cut_exit, ChatterKind::unknown, kNaN, "");
}

double Monitor::speed_at(std::int64_t stamp_ns) const noexcept {
  return settings_.has_speed_signal ? std::max(0.0, speed_.at(stamp_ns)) : settings_.nominal_speed;
}

double Monitor::speed_uncertainty() const noexcept { return settings_.has_speed_signal ? speed_.uncertainty() : 0.0; }

double Monitor::away_from_order(double frequency_hz) const noexcept {
  return spindle_hz() > 0.0 ? std::abs(std::remainder(frequency_hz, spindle_hz())) : frequency_hz;
}

ChatterKind Monitor::name_kind(double frequency_hz) const noexcept {
  // Regenerative chatter stands near a mode of the structure (above it by tenths); far from all of them no name is
  // given.
  const bool expected = mode_count_ == 0 || near_a_mode(modes(), frequency_hz, kNearAMode);
  return expected ? ChatterKind::regenerative : ChatterKind::unknown;
}

}  // namespace stillcut
