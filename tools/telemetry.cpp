#include "tools/telemetry.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>

#include "models/machining.hpp"

namespace stillcut {
namespace {

constexpr std::int64_t kReportEvery_ns = 50'000'000;
constexpr std::int64_t kDiagramAtMostEvery_ns = 200'000'000, kDiagramAtLeastEvery_ns = 1'000'000'000;

// What an onlooker must see at once.
bool says_something_new(const LoopView& view, const LoopView& before) {
  return view.monitor.state != before.monitor.state || view.monitor.chatter != before.monitor.chatter ||
         view.monitor.structural != before.monitor.structural || view.monitor.kind != before.monitor.kind ||
         view.monitor.doubts != before.monitor.doubts || view.has_lobes != before.has_lobes;
}

DiagramReport diagram_report(std::int64_t stamp_ns, const LobeDiagram* lobes) {
  DiagramReport report;
  report.stamp_ns = stamp_ns;
  if (lobes == nullptr || !lobes->valid) return report;
  report.valid = true;
  report.posture_stamp_ns = lobes->posture_stamp_ns;
  report.speed_scatter = lobes->speed_scatter;
  report.depth_scatter = lobes->depth_scatter;
  for (const ModeSummary& mode : std::span{lobes->modes}.first(static_cast<std::size_t>(lobes->mode_count))) {
    report.mode_hz.push_back(static_cast<float>(mode.frequency_hz));
    report.mode_damping.push_back(static_cast<float>(mode.damping_ratio));
  }
  const auto points = std::span{lobes->points}.first(static_cast<std::size_t>(lobes->point_count));
  if (points.empty()) return report;  // a cut that the lobes cannot describe: modes only
  report.min_rpm = rad_s_to_rpm(points.front().speed);
  report.max_rpm = rad_s_to_rpm(points.back().speed);
  for (const LobePoint& point : points) report.depth_limit_mm.push_back(static_cast<float>(1e3 * point.depth_limit));
  return report;
}

}  // namespace

MonitorReport monitor_report(const LoopView& view, const LobeDiagram* lobes) {
  const MonitorView& heard = view.monitor;
  MonitorReport report;
  report.stamp_ns = view.now_ns;
  report.state = heard.state;
  report.mode = view.mode;
  report.chatter = heard.chatter || heard.structural;
  report.kind = heard.chatter ? heard.kind : ChatterKind::structural;
  report.doubts = heard.doubts;
  report.indicator = heard.indicator;
  report.spindle_speed_rpm = rad_s_to_rpm(heard.speed);
  report.structural_frequency_hz = heard.structural_frequency_hz;
  report.decay_per_s = heard.decay_per_s;
  report.decay_frequency_hz = heard.decay_frequency_hz;
  report.axial_depth = view.axial_depth;
  report.feed_direction = view.feed_direction;
  report.depth_limit = view.depth_limit;
  report.margin = view.margin;
  report.predicted_chatter_hz = view.predicted_chatter_hz;
  if (!report.chatter) return report;
  report.chatter_frequency_hz = heard.chatter ? heard.chatter_frequency_hz : heard.structural_frequency_hz;
  report.chatter_amplitude = heard.chatter ? heard.chatter_amplitude : kNaN;
  if (lobes == nullptr || lobes->mode_count == 0 || !std::isfinite(report.chatter_frequency_hz)) return report;
  const auto modes = std::span{lobes->modes}.first(static_cast<std::size_t>(lobes->mode_count));
  const auto nearest = std::min_element(modes.begin(), modes.end(), [&](const ModeSummary& a, const ModeSummary& b) {
    return std::abs(a.frequency_hz - report.chatter_frequency_hz) <
           std::abs(b.frequency_hz - report.chatter_frequency_hz);
  });
  report.chatter_mode = static_cast<int>(nearest - modes.begin()) + 1;
  report.chatter_mode_hz = nearest->frequency_hz;
  return report;
}

Telemetry::Telemetry(const Cell& cell, Tell tell) : tell_{std::move(tell)} {
  const int teeth = cell.tool ? cell.tool->teeth : 0;
  for (const AccelerometerSettings& sensor : require(cell, cell.can, "can").accelerometers)
    sensors_.emplace_back(static_cast<int>(sensors_.size()), sensor.sample_rate_hz, teeth);
}

void Telemetry::add(const SampleBlock& block) {
  if (block.sensor < sensors_.size()) sensors_[block.sensor].add(block);
}

void Telemetry::add(const LoopView& view, const LobeDiagram* lobes) {
  const std::int64_t period = view.now_ns / kReportEvery_ns;
  const bool due = period != period_;
  if (due || says_something_new(view, view_)) tell_(monitor_report(view, lobes));
  view_ = view;
  period_ = period;
  if (!due) return;
  tell_diagram(view, view.has_lobes ? lobes : nullptr);
  const double spindle_hz = view.monitor.speed / (2.0 * std::numbers::pi);
  for (SensorStream& sensor : sensors_) {
    SpectrumReport spectrum = sensor.spectrum(spindle_hz);
    spectrum.stamp_ns = view.now_ns;
    if (!spectrum.levels.empty()) tell_(spectrum);
    if (VibrationReport vibration = sensor.take_vibration(); !vibration.samples.empty()) tell_(vibration);
  }
}

void Telemetry::tell_diagram(const LoopView& view, const LobeDiagram* lobes) {
  const bool valid = lobes != nullptr && lobes->valid;
  const std::int64_t from_ns = valid ? lobes->usable_from_ns : 0;
  const bool other = valid != diagram_valid_ || from_ns != diagram_from_ns_;
  const std::int64_t since_ns = std::abs(view.now_ns - diagram_told_ns_);
  if (since_ns < (other ? kDiagramAtMostEvery_ns : kDiagramAtLeastEvery_ns)) return;
  tell_(diagram_report(view.now_ns, lobes));
  diagram_told_ns_ = view.now_ns;
  diagram_valid_ = valid;
  diagram_from_ns_ = from_ns;
}

HealthReport Telemetry::health(std::int64_t stamp_ns) const {
  HealthReport report;
  report.stamp_ns = stamp_ns;
  report.doubts = view_.monitor.doubts;
  report.frames = view_.core.frames;
  report.frames_bad = view_.decoder.frames_bad;
  report.frames_lost = view_.core.frames_lost;
  report.frames_out_of_order = view_.core.frames_out_of_order;
  for (const SensorStream& sensor : sensors_) report.sensors.push_back(sensor.health());
  return report;
}

}  // namespace stillcut
