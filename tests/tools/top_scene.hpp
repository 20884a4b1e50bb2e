// A cell as `stillcut top` may hear it: in chatter, everything heard, with much in every list.
#pragma once

#include "dsp/integrity.hpp"
#include "tools/cell_view.hpp"

namespace stillcut {

inline constexpr std::int64_t kHeard_ns = 1'000'000'000'000;

inline MonitorReport monitor_in_chatter() {
  MonitorReport report;
  report.stamp_ns = kHeard_ns;
  report.state = State::chatter;
  report.mode = RuntimeMode::active;
  report.chatter = true;
  report.kind = ChatterKind::regenerative;
  report.indicator = 1.7;
  report.spindle_speed_rpm = 8500.0;
  report.chatter_frequency_hz = 748.0;
  report.chatter_mode = 5;
  report.chatter_mode_hz = 752.0;
  report.axial_depth = 3.6e-3;
  report.depth_limit = 2.96e-3;
  report.margin = 2.96 / 3.6 - 1.0;
  report.predicted_chatter_hz = 756.1;
  return report;
}

inline Correction asked_of(CorrectionKind kind, std::int64_t stamp_ns) {
  Correction correction;
  correction.stamp_ns = stamp_ns;
  correction.valid_for_ms = 500;
  correction.mode = RuntimeMode::active;
  correction.kind = kind;
  correction.spindle_speed_target_rpm = 11220.0;
  correction.feed_direction = static_cast<double>(stamp_ns % 7);
  correction.limited_by = kLimitedBySpeedRange | kLimitedByPath | kNoStableSettingKnown;
  correction.confidence_percent = 80;
  correction.reason =
      short_text("n = 60 f_c / (N k), k = 2, with words until the text is full, as a controller reads it");
  return correction;
}

inline DiagramReport some_lobes() {
  DiagramReport report{kHeard_ns, kHeard_ns, true, 6000, 14000, 0.01, 0.1, {13.8F, 752.0F}, {0.05F, 0.025F}, {}};
  for (int i = 0; i < 201; ++i) report.depth_limit_mm.push_back(2.5F + static_cast<float>(i % 50) * 0.1F);
  report.depth_limit_mm[100] = std::numeric_limits<float>::infinity();
  report.depth_limit_mm[150] = std::numeric_limits<float>::quiet_NaN();
  return report;
}

inline CellView busy_cell() {
  CellView view;
  SpectrumReport spectrum{kHeard_ns, 0, 2, 0.16, 12.5, 141.7, -70.0, 0.5, {}};
  for (int i = 0; i < 401; ++i) spectrum.levels.push_back(static_cast<std::uint8_t>(i == 60 ? 240 : 40 + i % 90));
  HealthReport health;
  health.frames = 1'000'000;
  health.kernel_dropped = 12;
  health.doubts = kSaturated | kGap;
  health.sensors = {{25600, 25598.5, 3, 1, 4, 0}, {10000, 9000.0, 0, 0, 0, 9}};
  LatencyReport latency;
  latency.in_time = false;
  for (const char* stage :
       {"wake-up", "receive", "decode", "filter", "transform", "decide", "hand-over", "tick", "decision"})
    latency.stages.push_back({stage, 123456, 12.5, 40.0, 99.5, 4700.25});
  HistogramReport histogram;
  histogram.tick[10] = 7;
  for (int i = 0; i < 20; ++i) {
    Event event{kHeard_ns + i, EventType::chatter_onset, ChatterKind::structural, 21.5, 1.25, 8500.0, {}};
    event.note = short_text("start=3.580, and more that is worth saying of it");
    view.take(event, kHeard_ns);
  }
  for (const CorrectionKind kind :
       {CorrectionKind::spindle_speed, CorrectionKind::speed_variation, CorrectionKind::feed_direction,
        CorrectionKind::feed_override, CorrectionKind::stop_request, CorrectionKind::release,
        CorrectionKind::spindle_speed})
    view.take(asked_of(kind, kHeard_ns), kHeard_ns);
  view.take(spectrum, kHeard_ns);
  spectrum.sensor = 1;
  view.take(spectrum, kHeard_ns);
  for (const TelemetryMessage& message :
       {TelemetryMessage{some_lobes()}, TelemetryMessage{health}, TelemetryMessage{latency},
        TelemetryMessage{histogram}, TelemetryMessage{monitor_in_chatter()}})
    view.take(message, kHeard_ns);
  return view;
}

}  // namespace stillcut
