#include "drivers/lcm/telemetry_messages.hpp"

#include <algorithm>
#include <cmath>
#include <stillcut/diagram_t.hpp>
#include <stillcut/health_t.hpp>
#include <stillcut/histogram_t.hpp>
#include <stillcut/loop_times_t.hpp>
#include <stillcut/monitor_t.hpp>
#include <stillcut/spectrum_t.hpp>
#include <stillcut/vibration_t.hpp>

#include "drivers/lcm/message_bytes.hpp"

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

template <class T, class Container>
std::vector<T> copy_of(const Container& values) {
  return {values.begin(), values.end()};
}

// loop_times_t: names of at least their terminating zero, as many as it says, and no more stages than anyone has.
bool names_fit(std::span<const std::uint8_t> bytes) {
  constexpr std::size_t kStagesAt = 8 + 5 * 8 + 1, kMostStages = 64;
  if (bytes.size() < kStagesAt + kCountBytes) return false;
  const std::size_t stages = count_at(bytes, kStagesAt);
  if (stages > kMostStages) return false;
  std::size_t at = kStagesAt + kCountBytes;
  for (std::size_t i = 0; i < stages; ++i) {
    if (at + kCountBytes > bytes.size()) return false;
    const std::size_t length = count_at(bytes, at);
    if (length < 1 || length > bytes.size() - at - kCountBytes) return false;
    at += kCountBytes + length;
  }
  return at + stages * 5 * 8 == bytes.size();
}

}  // namespace

LatencyReport latency_report(const LoopTimes& times, std::int64_t stamp_ns) {
  const auto us = [](std::int64_t ns) { return static_cast<double>(ns) * 1e-3; };
  const auto count = [](std::uint64_t n) { return static_cast<std::int64_t>(n); };
  LatencyReport report{stamp_ns,
                       count(times.loop.ticks.load()),
                       count(times.loop.overruns.load()),
                       count(times.loop.skipped.load()),
                       count(times.times_out.load()),
                       times.in_time.load(),
                       {}};
  for (const NamedLatency& stage : named_latencies(times))
    report.stages.push_back({stage.name, count(stage.times.count), us(stage.times.p50_ns), us(stage.times.p99_ns),
                             us(stage.times.p999_ns), us(stage.times.max_ns)});
  return report;
}

HistogramReport histogram_report(const LoopTimes& times, std::int64_t stamp_ns) {
  HistogramReport report{.stamp_ns = stamp_ns};
  const auto fill = [](const LatencyHistogram& histogram, HistogramReport::Counts& counts) {
    histogram.for_each([&](std::int64_t longest_ns, std::uint64_t count) {
      const double octaves =
          std::log2(std::max(1.0, static_cast<double>(longest_ns) * 1e-3 / HistogramReport::kFirst_us));
      const auto bucket = static_cast<std::size_t>(octaves * HistogramReport::kPerOctave);
      counts[std::min(bucket, counts.size() - 1)] += static_cast<std::int64_t>(count);
    });
  };
  fill(times.loop.wakeup, report.wake_up);
  fill(times.loop.execution, report.tick);
  fill(times.decision, report.decision);
  return report;
}

MessageBytes encode(const MonitorReport& report) {
  monitor_t m{};
  m.utime = to_us(report.stamp_ns);
  m.state = static_cast<std::int8_t>(report.state);
  m.mode = static_cast<std::int8_t>(report.mode);
  m.kind = report.chatter ? static_cast<std::int8_t>(report.kind) : std::int8_t{-1};
  m.doubts = static_cast<std::int32_t>(report.doubts);
  m.indicator = report.indicator;
  m.spindle_speed_rpm = report.spindle_speed_rpm;
  m.chatter_frequency_hz = report.chatter_frequency_hz;
  m.chatter_amplitude_m_per_s2 = report.chatter_amplitude;
  m.chatter_mode = report.chatter_mode;
  m.chatter_mode_hz = report.chatter_mode_hz;
  m.structural_frequency_hz = report.structural_frequency_hz;
  m.decay_per_s = report.decay_per_s;
  m.decay_frequency_hz = report.decay_frequency_hz;
  m.axial_depth_m = report.axial_depth;
  m.feed_direction_rad = report.feed_direction;
  m.depth_limit_m = report.depth_limit;
  m.margin = report.margin;
  m.predicted_chatter_hz = report.predicted_chatter_hz;
  return to_bytes(m);
}

MessageBytes encode(const SpectrumReport& report) {
  spectrum_t m{};
  m.utime = to_us(report.stamp_ns);
  m.sensor = static_cast<std::int8_t>(report.sensor);
  m.teeth = static_cast<std::int8_t>(report.teeth);
  m.window_s = report.window_s;
  m.bin_hz = report.bin_hz;
  m.spindle_hz = report.spindle_hz;
  m.low_db = report.low_db;
  m.step_db = report.step_db;
  m.level = report.levels;
  m.bins = static_cast<std::int32_t>(m.level.size());
  return to_bytes(m);
}

MessageBytes encode(const VibrationReport& report) {
  vibration_t m{};
  m.utime = to_us(report.stamp_ns);
  m.sensor = static_cast<std::int8_t>(report.sensor);
  m.rate_hz = report.rate_hz;
  m.samples = static_cast<std::int32_t>(report.samples.size());
  for (const auto& sample : report.samples) m.m_per_s2.emplace_back(sample.begin(), sample.end());
  return to_bytes(m);
}

MessageBytes encode(const DiagramReport& report) {
  diagram_t m{};
  m.utime = to_us(report.stamp_ns);
  m.posture_utime = to_us(report.posture_stamp_ns);
  m.valid = report.valid ? 1 : 0;
  m.min_rpm = report.min_rpm;
  m.max_rpm = report.max_rpm;
  m.speed_scatter = report.speed_scatter;
  m.depth_scatter = report.depth_scatter;
  m.mode_hz = report.mode_hz;
  m.mode_damping = report.mode_damping;
  m.modes = static_cast<std::int32_t>(m.mode_hz.size());
  m.depth_limit_mm = report.depth_limit_mm;
  m.points = static_cast<std::int32_t>(m.depth_limit_mm.size());
  return to_bytes(m);
}

MessageBytes encode(const HealthReport& report) {
  health_t m{};
  m.utime = to_us(report.stamp_ns);
  m.bus_state = static_cast<std::int8_t>(report.bus_state);
  m.doubts = static_cast<std::int32_t>(report.doubts);
  m.frames = report.frames;
  m.kernel_dropped = report.kernel_dropped;
  m.error_frames = report.error_frames;
  m.bus_off = report.bus_off;
  m.reopened = report.reopened;
  m.frames_bad = report.frames_bad;
  m.frames_lost = report.frames_lost;
  m.frames_out_of_order = report.frames_out_of_order;
  m.outputs_dropped = report.outputs_dropped;
  m.record_dropped = report.record_dropped;
  m.telemetry_dropped = report.telemetry_dropped;
  m.messages_bad = report.messages_bad;
  m.publish_failed = report.publish_failed;
  m.sensors = static_cast<std::int32_t>(report.sensors.size());
  for (const SensorHealth& sensor : report.sensors) {
    m.nominal_rate_hz.push_back(sensor.nominal_rate_hz);
    m.rate_hz.push_back(sensor.rate_hz);
    m.lost.push_back(sensor.lost);
    m.gaps.push_back(sensor.gaps);
    m.saturated.push_back(sensor.saturated);
    m.not_finite.push_back(sensor.not_finite);
  }
  return to_bytes(m);
}

MessageBytes encode(const LatencyReport& report) {
  loop_times_t m{};
  m.utime = to_us(report.stamp_ns);
  m.ticks = report.ticks;
  m.overruns = report.overruns;
  m.skipped = report.skipped;
  m.times_out = report.times_out;
  m.in_time = report.in_time ? 1 : 0;
  for (const LatencyReport::Stage& stage : report.stages) {
    m.stage.push_back(stage.name);
    m.count.push_back(stage.count);
    m.p50_us.push_back(stage.p50_us);
    m.p99_us.push_back(stage.p99_us);
    m.p999_us.push_back(stage.p999_us);
    m.max_us.push_back(stage.max_us);
  }
  m.stages = static_cast<std::int32_t>(m.stage.size());
  return to_bytes(m);
}

MessageBytes encode(const HistogramReport& report) {
  histogram_t m{};
  m.utime = to_us(report.stamp_ns);
  m.first_us = HistogramReport::kFirst_us;
  m.per_octave = HistogramReport::kPerOctave;
  m.buckets = static_cast<std::int32_t>(HistogramReport::kBuckets);
  m.wake_up = copy_of<std::int64_t>(report.wake_up);
  m.tick = copy_of<std::int64_t>(report.tick);
  m.decision = copy_of<std::int64_t>(report.decision);
  return to_bytes(m);
}

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
