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

template <class T, class Container>
std::vector<T> copy_of(const Container& values) {
  return {values.begin(), values.end()};
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

}  // namespace stillcut
