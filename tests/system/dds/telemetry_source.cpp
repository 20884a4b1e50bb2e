// telemetry_source LCM-URL SECONDS SPEED-RPM: speaks on LCM as the daemon does, every kind of message at its rate, with
// contents that can be told by their number (told.h). Prints at its end how many of each it sent.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <thread>

#include "drivers/lcm/connection.hpp"
#include "drivers/lcm/telemetry_messages.hpp"
#include "tests/system/dds/told.h"

namespace stillcut {
namespace {

constexpr std::int64_t kMs = 1'000'000;

std::int64_t stamp_ns(long n, int period_ms) { return (std::int64_t{FIRST_STAMP_S} * 1000 + n * period_ms) * kMs; }

Status status(long n, double speed_rpm) {
  Status s;
  s.stamp_ns = stamp_ns(n, STATUS_MS);
  s.state = State::cut;
  s.mode = RuntimeMode::active;
  s.spindle_speed_rpm = speed_rpm;
  s.indicator = told_indicator(n);
  s.margin = 0.25;
  s.chatter_frequency_hz = kNaN;
  s.frames = n;
  s.frames_lost = 3;
  s.lobes_stamp_ns = stamp_ns(n, STATUS_MS) - 500 * kMs;
  return s;
}

MonitorReport monitor(long n, double speed_rpm) {
  MonitorReport r;
  r.stamp_ns = stamp_ns(n, INDICATOR_MS);
  r.state = State::chatter;
  r.mode = RuntimeMode::shadow;
  r.chatter = true;
  r.kind = ChatterKind::regenerative;
  r.doubts = 1U << 1U;
  r.indicator = told_indicator(n);
  r.spindle_speed_rpm = speed_rpm;
  r.chatter_frequency_hz = told_frequency(n);
  r.chatter_amplitude = 1.5;
  r.chatter_mode = 2;
  r.chatter_mode_hz = 2.5;
  r.structural_frequency_hz = 3.5;
  r.decay_per_s = 4.5;
  r.decay_frequency_hz = 5.5;
  r.axial_depth = 6.5;
  r.feed_direction = 0.75;
  r.depth_limit = kInfinity;
  r.margin = 8.5;
  r.predicted_chatter_hz = 9.5;
  return r;
}

SpectrumReport spectrum(long n) {
  SpectrumReport r;
  r.stamp_ns = stamp_ns(n, SPECTRUM_MS);
  r.sensor = 1;
  r.teeth = 4;
  r.window_s = 0.125;
  r.bin_hz = 8.0;
  r.spindle_hz = 150.0;
  r.low_db = TOLD_LOW_DB;
  r.step_db = TOLD_STEP_DB;
  for (long bin = 0; bin < SPECTRUM_BINS; ++bin) r.levels.push_back(told_level(n, bin));
  return r;
}

VibrationReport vibration(long message) {
  const long first = message * VIBRATION_SAMPLES;
  VibrationReport r;
  r.stamp_ns = stamp_ns(first + VIBRATION_SAMPLES - 1, VIBRATION_MS);
  r.rate_hz = 1000.0 / int{VIBRATION_MS};
  for (long n = first; n < first + VIBRATION_SAMPLES; ++n)
    r.samples.push_back({told_acceleration(n, 0), told_acceleration(n, 1), told_acceleration(n, 2)});
  return r;
}

Correction correction(long n) {
  Correction c;
  c.stamp_ns = stamp_ns(n, CORRECTION_MS);
  c.sequence = n;
  c.valid_for_ms = 500;
  c.mode = RuntimeMode::active;
  c.kind = CorrectionKind::speed_variation;
  c.spindle_speed_rpm = 7500.5;
  c.spindle_speed_target_rpm = 7600.5;
  c.speed_variation_ratio = 0.125;
  c.speed_variation_hz = 1.5;
  c.feed_override = 0.875;
  c.feed_direction = 0.5;
  c.chatter_frequency_hz = told_frequency(n);
  c.predicted_margin_before = -0.25;
  c.predicted_margin_after = 0.5;
  c.limited_by = 17;
  c.confidence_percent = 80;
  c.reason = short_text("reason " + std::to_string(n));
  return c;
}

Event event(long n) {
  Event e;
  e.stamp_ns = stamp_ns(n, EVENT_MS);
  e.type = EventType::chatter_onset;
  e.kind = ChatterKind::structural;
  e.frequency_hz = told_frequency(n);
  e.indicator = told_indicator(n);
  e.spindle_speed_rpm = 9000.5;
  e.note = short_text("note " + std::to_string(n));
  return e;
}

DiagramReport diagram(long n) {
  DiagramReport r;
  r.stamp_ns = stamp_ns(n, LOBES_MS);
  r.posture_stamp_ns = stamp_ns(n, LOBES_MS) - 20 * kMs;
  r.valid = true;
  r.min_rpm = 6000.0;
  r.max_rpm = 14000.0;
  r.speed_scatter = 0.0625;
  r.depth_scatter = 0.25;
  r.mode_hz = {11.5F, 712.0F};
  r.mode_damping = {0.03125F, 0.0625F};
  for (long point = 0; point < LOBES_POINTS; ++point) r.depth_limit_mm.push_back(told_limit_mm(n, point));
  return r;
}

HealthReport health(long n) {
  HealthReport r;
  r.stamp_ns = stamp_ns(n, HEALTH_MS);
  r.frames = 2560 * n;
  r.sensors = {{25600.0, 25599.5, 0, 0, 0, 0}};
  return r;
}

class Source {
 public:
  explicit Source(const char* url) : connection_{open_lcm(url)} {}
  // Message number n where `ms` is a multiple of the period; counts what could be sent.
  template <class Make>
  void send_at(long ms, int period_ms, const char* channel, long& sent, Make make) {
    if (ms % period_ms != 0) return;
    const MessageBytes bytes = encode(make(ms / period_ms));
    if (lcm_publish(connection_.get(), channel, bytes.data(), static_cast<unsigned>(bytes.size())) == 0) ++sent;
  }

 private:
  LcmConnection connection_;
};

void run(const char* url, long seconds, double speed_rpm) {
  Source source{url};
  const auto start = std::chrono::steady_clock::now();
  const LoopTimes times;
  long statuses = 0, monitors = 0, spectra = 0, vibrations = 0, corrections = 0, events = 0, diagrams = 0, healths = 0;
  for (long ms = 0; ms < seconds * 1000; ms += VIBRATION_MS) {
    std::this_thread::sleep_until(start + std::chrono::milliseconds(ms));
    source.send_at(ms, STATUS_MS, kStatusChannel, statuses, [&](long n) { return status(n, speed_rpm); });
    source.send_at(ms, INDICATOR_MS, kMonitorChannel, monitors, [&](long n) { return monitor(n, speed_rpm); });
    source.send_at(ms, SPECTRUM_MS, kSpectrumChannel, spectra, spectrum);
    source.send_at(ms, VIBRATION_MS * VIBRATION_SAMPLES, kVibrationChannel, vibrations, vibration);
    source.send_at(ms, CORRECTION_MS, kCorrectionChannel, corrections, correction);
    source.send_at(ms, EVENT_MS, kEventChannel, events, event);
    source.send_at(ms, LOBES_MS, kDiagramChannel, diagrams, diagram);
    source.send_at(ms, HEALTH_MS, kHealthChannel, healths, health);
  }
  std::printf(
      "{\"status\": %ld, \"indicator\": %ld, \"spectrum\": %ld, \"vibration\": %ld, \"correction\": %ld, \"event\": "
      "%ld, "
      "\"lobes\": %ld}\n",
      statuses, monitors, spectra, vibrations * VIBRATION_SAMPLES, corrections, events, diagrams);
}

}  // namespace
}  // namespace stillcut

int main(int argc, char** argv) {
  if (argc != 4) return 2;
  stillcut::run(argv[1], std::atol(argv[2]), std::atof(argv[3]));
  return 0;
}
