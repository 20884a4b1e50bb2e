#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include "dsp/monitor.hpp"
#include "tests/bench/detection/detectors.hpp"

namespace stillcut::detection {
namespace {

constexpr std::int64_t kPriorEvery_ns = 100'000'000;  // as the core does with its status
constexpr double kPriorStep = 0.1;                    // of margin

MonitorSettings settings_of(const CutPlan& plan) {
  MonitorSettings settings;
  settings.sensors = {SensorSettings{plan.sensor_rate_hz, 7}};
  settings.highest_speed = 1.1 * plan.setup.fastest;
  settings.nominal_speed = plan.setup.cut.spindle_speed;
  settings.teeth = plan.setup.tool.teeth;
  return settings;
}

// Episodes so far; the open one of either kind of chatter, if there is one: the tool's, and the structure's beside it.
struct Heard {
  std::vector<Alarm> alarms;
  std::optional<std::size_t> tool, structural;
};

double seconds(std::int64_t stamp_ns) { return static_cast<double>(stamp_ns - kOrigin_ns) * 1e-9; }

void collect(const Monitor& monitor, Heard& heard) {
  for (const Event& event : monitor.events()) {
    std::optional<std::size_t>& open = event.kind == ChatterKind::structural ? heard.structural : heard.tool;
    if (event.type == EventType::chatter_end) {
      if (open) heard.alarms[*open].end = seconds(event.stamp_ns);
      open.reset();
    }
    if (event.type != EventType::chatter_onset) continue;
    if (!open) {
      open = heard.alarms.size();
      Alarm alarm;
      alarm.time = seconds(event.stamp_ns);
      alarm.frequency_hz = event.frequency_hz;
      heard.alarms.push_back(alarm);
    }
    Alarm& alarm = heard.alarms[*open];
    alarm.kind = event.kind;
    alarm.called_regenerative = alarm.called_regenerative || event.kind == ChatterKind::regenerative;
    alarm.called_structural = alarm.called_structural || event.kind == ChatterKind::structural;
  }
}

// What is heard of the open episodes now.
void follow(const MonitorView& view, double now, Heard& heard) {
  if (heard.tool) {
    Alarm& alarm = heard.alarms[*heard.tool];
    if (now >= alarm.time + 0.025 && std::isnan(alarm.after_25ms_hz)) alarm.after_25ms_hz = view.chatter_frequency_hz;
    if (now >= alarm.time + 0.25 && std::isnan(alarm.after_250ms_hz)) alarm.after_250ms_hz = view.chatter_frequency_hz;
  }
  if (heard.structural) {
    Alarm& alarm = heard.alarms[*heard.structural];
    while (now >= alarm.time + static_cast<double>(alarm.track_hz.size()) * kTrack_s)
      alarm.track_hz.push_back(view.structural_frequency_hz);
  }
}

}  // namespace

std::vector<Alarm> ask_monitor(const CutPlan& plan, const MilledCut& cut) {
  const auto monitor = std::make_unique<Monitor>(settings_of(plan));
  monitor->set_origin(kOrigin_ns);
  Heard heard;
  double told = kInfinity;
  std::int64_t next_prior_ns = 0;
  std::size_t reading = 0;
  for (const SampleBlock& block : cut.blocks) {
    for (; reading < cut.readings.size() && cut.readings[reading].stamp_ns <= block.stamp_ns; ++reading)
      monitor->add_speed(cut.readings[reading]);
    const double now = seconds(block.stamp_ns);
    if (block.stamp_ns >= next_prior_ns) {
      next_prior_ns = block.stamp_ns + kPriorEvery_ns;
      const double depth = value_at(plan.schedule.axial_depth, now);
      const double margin = depth > 0.0 ? plan.map_limit / depth - 1.0 : kInfinity;
      if (!(std::abs(margin - told) <= kPriorStep)) monitor->expect(plan.map_modes, told = margin);
    }
    monitor->advance(block.stamp_ns);
    monitor->add_samples(block);
    collect(*monitor, heard);
    monitor->clear_events();
    follow(monitor->view(), now, heard);
  }
  return heard.alarms;
}

}  // namespace stillcut::detection
