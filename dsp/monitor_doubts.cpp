// The part of the monitor that says when it cannot tell: lost samples, sensors and speed that are not to be believed.
#include <bit>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "dsp/monitor.hpp"
#include "dsp/numbers.hpp"

namespace stillcut {
namespace {

constexpr std::int64_t kSpeedSilence_ns = 300'000'000;  // drives send their speed at 10 Hz or more
constexpr std::int64_t kSensorSilence_ns = 100'000'000;
constexpr std::int64_t kSensorStart_ns = 500'000'000;
constexpr std::int64_t kLossEventEvery_ns = 1'000'000'000;
constexpr double kDoubtClears_s = 0.5;

}  // namespace

// A doubt that newly holds is a fault event. It is dropped again only after it has been absent for a while, so that a
// sensor that comes and goes is one fault.
void Monitor::set_doubts(std::uint32_t mask, std::uint32_t doubts, std::int64_t stamp_ns, double seconds) noexcept {
  for (int d = 0; d < kDoubtCount; ++d) {
    const std::uint32_t bit = 1U << d;
    if ((mask & bit) == 0) continue;
    if ((doubts & bit) != 0) {
      clear_for_s_[d] = 0.0;
      if ((view_.doubts & bit) == 0) {
        view_.doubts |= bit;
        emit(stamp_ns, EventType::fault, ChatterKind::unknown, kNaN, describe(static_cast<Doubt>(bit)));
      }
    } else if ((view_.doubts & bit) != 0) {
      clear_for_s_[d] += seconds;
      if (clear_for_s_[d] >= kDoubtClears_s) view_.doubts &= ~bit;
    }
  }
}

void Monitor::update_speed_doubts(std::int64_t stamp_ns, double step_s) noexcept {
  if (!settings_.has_speed_signal) return;
  const std::int64_t heard_ns = speed_.has_reading() ? speed_.last_stamp_ns() : first_sample_ns_;
  std::uint32_t doubts = speed_fault_;
  if (stamp_ns - heard_ns > kSpeedSilence_ns && speed_fault_ == kNoDoubt) doubts |= kSpeedMissing;
  double power = 0.0;
  for (const Sensor& each : sensors_) power += each.path.level() * each.path.level();
  if (speed_.has_reading() && view_.speed < settings_.gate.idle_speed && gate_.at_cutting_level(std::sqrt(power))) {
    doubts |= kSpeedImplausible;
  }
  set_doubts(kSpeedMissing | kSpeedImplausible, doubts, stamp_ns, step_s);
}

// Lost frames that the window can bridge are told once a second, not once a frame; longer gaps raise kGap as well.
void Monitor::report_lost_frames(Sensor& sensor, std::int64_t samples_lost, std::int64_t stamp_ns) noexcept {
  view_.samples_lost += samples_lost;
  ++sensor.losses;
  if (sensor.last_loss_event_ns != 0 && stamp_ns - sensor.last_loss_event_ns < kLossEventEvery_ns) return;
  sensor.last_loss_event_ns = stamp_ns;
  char note[96];
  std::snprintf(note, sizeof note, "samples lost: %.1f ms before %.3f s; %lld times so far",
                static_cast<double>(samples_lost) * 1e3 / sensor.path.sample_rate_hz(),
                static_cast<double>(stamp_ns - origin_ns_) * 1e-9, static_cast<long long>(sensor.losses));
  emit(stamp_ns, EventType::fault, ChatterKind::unknown, kNaN, note);
}

// When the silence of a sensor falls due: a tenth of a second after its last frame, longer for one that never spoke.
std::int64_t Monitor::silence_due_ns(const Sensor& sensor) const noexcept {
  return sensor.heard ? sensor.last_arrival_ns + kSensorSilence_ns : origin_ns_ + kSensorStart_ns;
}

void Monitor::advance(std::int64_t now_ns) noexcept {
  for (const Sensor& sensor : sensors_) {
    const std::int64_t due_ns = silence_due_ns(sensor);
    if (origin_ns_ == 0 || now_ns < due_ns) continue;
    set_doubts(kSensorSilent, kSensorSilent, due_ns, 0.0);
    view_.state = State::cannot_tell;
    view_.indicator = kNaN;
  }
}

void Monitor::update_silence(std::int64_t stamp_ns, double step_s) noexcept {
  bool silent = false;
  for (const Sensor& sensor : sensors_) silent = silent || stamp_ns >= silence_due_ns(sensor);
  set_doubts(kSensorSilent, silent ? kSensorSilent : kNoDoubt, stamp_ns, step_s);
}

void Monitor::emit(std::int64_t stamp_ns, EventType type, ChatterKind kind, double frequency_hz,
                   const char* note) noexcept {
  if (event_count_ == kMaxEvents) return;
  const bool about_chatter = type == EventType::chatter_onset || type == EventType::chatter_end;
  events_[event_count_++] = {stamp_ns,
                             type,
                             kind,
                             frequency_hz,
                             about_chatter ? view_.indicator : kNaN,
                             view_.speed * 60.0 / (2.0 * std::numbers::pi),
                             short_text(note)};
}

}  // namespace stillcut
