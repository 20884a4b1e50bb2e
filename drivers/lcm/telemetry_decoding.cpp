// The decoders of telemetry_messages.hpp: bytes from anyone become a report or a reason why not.
#include <algorithm>
#include <stillcut/diagram_t.hpp>
#include <stillcut/health_t.hpp>
#include <stillcut/histogram_t.hpp>
#include <stillcut/loop_times_t.hpp>
#include <stillcut/monitor_t.hpp>
#include <stillcut/spectrum_t.hpp>
#include <stillcut/vibration_t.hpp>

#include "drivers/lcm/message_bytes.hpp"
#include "drivers/lcm/telemetry_messages.hpp"

namespace stillcut {
namespace {

constexpr const char* kOfAnotherType = "the bytes are no message of this type; is the sender of another version?";
constexpr const char* kTimeOut = "utime is out of range";
constexpr std::size_t kCountBytes = 4;

// For types that end with one count and its arrays: `message` comes as its default.
template <class Message>
bool counted(std::span<const std::uint8_t> bytes, Message& message, std::size_t most, std::size_t bytes_each) {
  const auto empty = static_cast<std::size_t>(message.getEncodedSize());
  if (bytes.size() < empty) return false;
  const std::size_t count = count_at(bytes, empty - kCountBytes);
  return count <= most && bytes.size() == empty + count * bytes_each && decode_whole(bytes, message);
}

// loop_times_t: names that end with their only zero, as many as it says, and no more stages than anyone has.
bool names_fit(std::span<const std::uint8_t> bytes) {
  constexpr std::size_t kStagesAt = 8 + 5 * 8 + 1, kMostStages = 64;
  if (bytes.size() < kStagesAt + kCountBytes) return false;
  const std::size_t stages = count_at(bytes, kStagesAt);
  if (stages > kMostStages) return false;
  std::size_t at = kStagesAt + kCountBytes;
  for (std::size_t i = 0; i < stages; ++i) {
    if (at + kCountBytes > bytes.size()) return false;
    const std::size_t length = count_at(bytes, at);
    at += kCountBytes;
    if (length < 1 || length > bytes.size() - at) return false;
    const auto name = bytes.subspan(at, length);
    if (std::find(name.begin(), name.end(), 0) != name.end() - 1) return false;
    at += length;
  }
  return at + stages * 5 * 8 == bytes.size();
}

}  // namespace

Received<MonitorReport> decode_monitor(std::span<const std::uint8_t> bytes) {
  monitor_t m{};
  if (!decode_whole(bytes, m)) return {{}, kOfAnotherType};
  if (!is_time(m.utime)) return {{}, kTimeOut};
  if (m.state < 0 || m.state > 7) return {{}, "state is not from 0 to 7"};
  if (m.mode < 0 || m.mode > 2) return {{}, "mode is not 0, 1 or 2"};
  if (m.kind < -1 || m.kind > 2) return {{}, "kind is not from -1 to 2"};
  return {{.stamp_ns = m.utime * kNsPerUs,
           .state = static_cast<State>(m.state),
           .mode = static_cast<RuntimeMode>(m.mode),
           .chatter = m.kind >= 0,
           .kind = static_cast<ChatterKind>(std::max<std::int8_t>(m.kind, 0)),
           .doubts = static_cast<std::uint32_t>(m.doubts),
           .indicator = m.indicator,
           .spindle_speed_rpm = m.spindle_speed_rpm,
           .chatter_frequency_hz = m.chatter_frequency_hz,
           .chatter_amplitude = m.chatter_amplitude_m_per_s2,
           .chatter_mode = m.chatter_mode,
           .chatter_mode_hz = m.chatter_mode_hz,
           .structural_frequency_hz = m.structural_frequency_hz,
           .decay_per_s = m.decay_per_s,
           .decay_frequency_hz = m.decay_frequency_hz,
           .axial_depth = m.axial_depth_m,
           .feed_direction = m.feed_direction_rad,
           .depth_limit = m.depth_limit_m,
           .margin = m.margin,
           .predicted_chatter_hz = m.predicted_chatter_hz}};
}

Received<SpectrumReport> decode_spectrum(std::span<const std::uint8_t> bytes) {
  spectrum_t m{};
  if (!counted(bytes, m, SpectrumReport::kMaxBins, 1)) return {{}, kOfAnotherType};
  if (!is_time(m.utime)) return {{}, kTimeOut};
  return {{m.utime * kNsPerUs, m.sensor, m.teeth, m.window_s, m.bin_hz, m.spindle_hz, m.low_db, m.step_db,
           std::move(m.level)}};
}

Received<VibrationReport> decode_vibration(std::span<const std::uint8_t> bytes) {
  vibration_t m{};
  if (!counted(bytes, m, VibrationReport::kMaxSamples, sizeof(float) * kMaxAxes)) return {{}, kOfAnotherType};
  if (!is_time(m.utime)) return {{}, kTimeOut};
  VibrationReport report{m.utime * kNsPerUs, m.sensor, m.rate_hz, {}};
  for (const auto& sample : m.m_per_s2) report.samples.push_back({sample[0], sample[1], sample[2]});
  return {report};
}

Received<DiagramReport> decode_diagram(std::span<const std::uint8_t> bytes) {
  constexpr std::size_t kModesAt = 8 + 2 * 8 + 1 + 4 * 8, kPair = 2 * sizeof(float);
  if (bytes.size() < kModesAt + kCountBytes) return {{}, kOfAnotherType};
  const std::size_t modes = count_at(bytes, kModesAt), points_at = kModesAt + kCountBytes + modes * kPair;
  if (modes > DiagramReport::kMaxModes || bytes.size() < points_at + kCountBytes) return {{}, kOfAnotherType};
  const std::size_t points = count_at(bytes, points_at);
  diagram_t m{};
  if (points > DiagramReport::kMaxPoints || bytes.size() != points_at + kCountBytes + points * sizeof(float) ||
      !decode_whole(bytes, m))
    return {{}, kOfAnotherType};
  if (!is_time(m.utime) || !is_time(m.posture_utime)) return {{}, kTimeOut};
  return {{m.utime * kNsPerUs, m.posture_utime * kNsPerUs, m.valid != 0, m.min_rpm, m.max_rpm, m.speed_scatter,
           m.depth_scatter, std::move(m.mode_hz), std::move(m.mode_damping), std::move(m.depth_limit_mm)}};
}

Received<HealthReport> decode_health(std::span<const std::uint8_t> bytes) {
  health_t m{};
  if (!counted(bytes, m, kMaxSensors, 6 * 8)) return {{}, kOfAnotherType};
  if (!is_time(m.utime)) return {{}, kTimeOut};
  HealthReport report{.stamp_ns = m.utime * kNsPerUs,
                      .bus_state = m.bus_state,
                      .doubts = static_cast<std::uint32_t>(m.doubts),
                      .frames = m.frames,
                      .kernel_dropped = m.kernel_dropped,
                      .error_frames = m.error_frames,
                      .bus_off = m.bus_off,
                      .reopened = m.reopened,
                      .frames_bad = m.frames_bad,
                      .frames_lost = m.frames_lost,
                      .frames_out_of_order = m.frames_out_of_order,
                      .outputs_dropped = m.outputs_dropped,
                      .record_dropped = m.record_dropped,
                      .telemetry_dropped = m.telemetry_dropped,
                      .messages_bad = m.messages_bad,
                      .publish_failed = m.publish_failed,
                      .sensors = {}};
  for (std::size_t i = 0; i < m.rate_hz.size(); ++i)
    report.sensors.push_back(
        {m.nominal_rate_hz[i], m.rate_hz[i], m.lost[i], m.gaps[i], m.saturated[i], m.not_finite[i]});
  return {report};
}

Received<LatencyReport> decode_latency(std::span<const std::uint8_t> bytes) {
  loop_times_t m{};
  if (!names_fit(bytes) || !decode_whole(bytes, m)) return {{}, kOfAnotherType};
  if (!is_time(m.utime)) return {{}, kTimeOut};
  LatencyReport report{m.utime * kNsPerUs, m.ticks, m.overruns, m.skipped, m.times_out, m.in_time != 0, {}};
  for (std::size_t i = 0; i < m.stage.size(); ++i)
    report.stages.push_back({m.stage[i], m.count[i], m.p50_us[i], m.p99_us[i], m.p999_us[i], m.max_us[i]});
  return {report};
}

Received<HistogramReport> decode_histogram(std::span<const std::uint8_t> bytes) {
  histogram_t m{};
  if (!counted(bytes, m, HistogramReport::kBuckets, 3 * 8)) return {{}, kOfAnotherType};
  if (!is_time(m.utime)) return {{}, kTimeOut};
  if (m.first_us != HistogramReport::kFirst_us || m.per_octave != HistogramReport::kPerOctave ||
      m.wake_up.size() != HistogramReport::kBuckets)
    return {{}, "buckets of another kind; is the sender of another version?"};
  HistogramReport report{.stamp_ns = m.utime * kNsPerUs};
  std::copy(m.wake_up.begin(), m.wake_up.end(), report.wake_up.begin());
  std::copy(m.tick.begin(), m.tick.end(), report.tick.begin());
  std::copy(m.decision.begin(), m.decision.end(), report.decision.begin());
  return {report};
}

}  // namespace stillcut
