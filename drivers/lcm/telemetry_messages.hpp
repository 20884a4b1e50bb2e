// What the daemon tells onlookers beside events, corrections and status (messages.hpp): plain values, and their way to
// LCM bytes and back. Nothing here is decided upon; all of it can be made again from a recording. Quantities are SI
// unless the name says otherwise; NaN is unknown.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "drivers/lcm/messages.hpp"
#include "dsp/numbers.hpp"
#include "rt/loop_times.hpp"

namespace stillcut {

inline constexpr const char *kMonitorChannel = "STILLCUT_MONITOR", *kSpectrumChannel = "STILLCUT_SPECTRUM",
                            *kVibrationChannel = "STILLCUT_VIBRATION", *kDiagramChannel = "STILLCUT_DIAGRAM",
                            *kHealthChannel = "STILLCUT_HEALTH", *kLatencyChannel = "STILLCUT_LATENCY",
                            *kHistogramChannel = "STILLCUT_HISTOGRAM";

// monitor_t
struct MonitorReport {
  std::int64_t stamp_ns = 0;
  State state = State::idle;
  RuntimeMode mode = RuntimeMode::shadow;
  bool chatter = false;  // of the tool or the structure
  ChatterKind kind = ChatterKind::unknown;
  std::uint32_t doubts = 0;
  double indicator = kNaN;
  double spindle_speed_rpm = kNaN;
  double chatter_frequency_hz = kNaN, chatter_amplitude = kNaN;
  int chatter_mode = 0;  // from 1; 0: none
  double chatter_mode_hz = kNaN;
  double structural_frequency_hz = kNaN;
  double decay_per_s = kNaN, decay_frequency_hz = kNaN;
  double axial_depth = kNaN, feed_direction = kNaN;
  double depth_limit = kNaN, margin = kNaN;
  double predicted_chatter_hz = kNaN;
};

// spectrum_t
struct SpectrumReport {
  static constexpr std::size_t kMaxBins = 512;

  std::int64_t stamp_ns = 0;
  int sensor = 0;
  int teeth = 0;
  double window_s = 0.0;
  double bin_hz = 0.0;
  double spindle_hz = kNaN;
  double low_db = 0.0, step_db = 0.0;
  std::vector<std::uint8_t> levels;
};

// vibration_t
struct VibrationReport {
  static constexpr std::size_t kMaxSamples = 64;

  std::int64_t stamp_ns = 0;  // of the last sample
  int sensor = 0;
  double rate_hz = 0.0;
  std::vector<std::array<float, kMaxAxes>> samples;  // m/s^2; an axis that is not measured is NaN
};

// diagram_t
struct DiagramReport {
  static constexpr std::size_t kMaxPoints = 256, kMaxModes = 16;

  std::int64_t stamp_ns = 0, posture_stamp_ns = 0;
  bool valid = false;
  double min_rpm = 0.0, max_rpm = 0.0;
  double speed_scatter = 0.0, depth_scatter = 0.0;
  std::vector<float> mode_hz, mode_damping;  // as many
  std::vector<float> depth_limit_mm;         // inf: none; NaN: unstable at every depth
};

struct SensorHealth {
  double nominal_rate_hz = 0.0;
  double rate_hz = kNaN;
  std::int64_t lost = 0, gaps = 0, saturated = 0, not_finite = 0;
};

// health_t
struct HealthReport {
  std::int64_t stamp_ns = 0;
  int bus_state = 0;  // BusState
  std::uint32_t doubts = 0;
  std::int64_t frames = 0, kernel_dropped = 0, error_frames = 0, bus_off = 0, reopened = 0, frames_bad = 0,
               frames_lost = 0, frames_out_of_order = 0, outputs_dropped = 0, record_dropped = 0, telemetry_dropped = 0,
               messages_bad = 0, publish_failed = 0;
  std::vector<SensorHealth> sensors;  // at most kMaxSensors
};

// loop_times_t
struct LatencyReport {
  struct Stage {
    std::string name;
    std::int64_t count = 0;
    double p50_us = 0.0, p99_us = 0.0, p999_us = 0.0, max_us = 0.0;
  };

  std::int64_t stamp_ns = 0;
  std::int64_t ticks = 0, overruns = 0, skipped = 0, times_out = 0;
  bool in_time = true;
  std::vector<Stage> stages;
};
LatencyReport latency_report(const LoopTimes& times, std::int64_t stamp_ns);

// histogram_t
struct HistogramReport {
  static constexpr double kFirst_us = 1.0;
  static constexpr int kPerOctave = 3;
  static constexpr std::size_t kBuckets = 52;  // to 0.16 s
  using Counts = std::array<std::int64_t, kBuckets>;

  std::int64_t stamp_ns = 0;
  Counts wake_up{}, tick{}, decision{};
};
HistogramReport histogram_report(const LoopTimes& times, std::int64_t stamp_ns);

MessageBytes encode(const MonitorReport& report);
MessageBytes encode(const SpectrumReport& report);
MessageBytes encode(const VibrationReport& report);
MessageBytes encode(const DiagramReport& report);
MessageBytes encode(const HealthReport& report);
MessageBytes encode(const LatencyReport& report);
MessageBytes encode(const HistogramReport& report);

// Refused: bytes of another type or length, counts beyond the bounds above, states and kinds out of range.
Received<MonitorReport> decode_monitor(std::span<const std::uint8_t> bytes);
Received<SpectrumReport> decode_spectrum(std::span<const std::uint8_t> bytes);
Received<VibrationReport> decode_vibration(std::span<const std::uint8_t> bytes);
Received<DiagramReport> decode_diagram(std::span<const std::uint8_t> bytes);
Received<HealthReport> decode_health(std::span<const std::uint8_t> bytes);
Received<LatencyReport> decode_latency(std::span<const std::uint8_t> bytes);
Received<HistogramReport> decode_histogram(std::span<const std::uint8_t> bytes);

// All that the daemon publishes.
using TelemetryMessage = std::variant<Status, Event, Correction, MonitorReport, SpectrumReport, VibrationReport,
                                      DiagramReport, HealthReport, LatencyReport, HistogramReport>;

const char* channel_of(const TelemetryMessage& message) noexcept;
// By the channel's name. Nothing of ours: "not a channel of Stillcut's".
Received<TelemetryMessage> decode_telemetry(std::string_view channel, std::span<const std::uint8_t> bytes);
// Every channel that decode_telemetry knows.
std::span<const char* const> telemetry_channels() noexcept;

}  // namespace stillcut
