#include <algorithm>
#include <cmath>
#include <memory>

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
  return settings;
}

void collect(const Monitor& monitor, std::vector<Alarm>& alarms, bool& open) {
  for (const Event& event : monitor.events()) {
    const double time = static_cast<double>(event.stamp_ns - kOrigin_ns) * 1e-9;
    if (event.type == EventType::chatter_end) {
      if (open) alarms.back().end = time;
      open = false;
    }
    if (event.type != EventType::chatter_onset) continue;
    const bool second_kind = open && event.kind != ChatterKind::unknown && alarms.back().kind != ChatterKind::unknown &&
                             alarms.back().kind != event.kind;
    if (!open || second_kind) {
      Alarm alarm;
      alarm.time = time;
      alarm.frequency_hz = event.frequency_hz;
      alarms.push_back(alarm);
    }
    open = true;
    Alarm& alarm = alarms.back();
    alarm.kind = event.kind;
    alarm.called_regenerative = alarm.called_regenerative || event.kind == ChatterKind::regenerative;
    alarm.called_structural = alarm.called_structural || event.kind == ChatterKind::structural;
  }
}

}  // namespace

std::vector<Alarm> ask_monitor(const CutPlan& plan, const MilledCut& cut) {
  const auto monitor = std::make_unique<Monitor>(settings_of(plan));
  monitor->set_origin(kOrigin_ns);
  std::vector<Alarm> alarms;
  bool open = false;
  double told = kInfinity;
  std::int64_t next_prior_ns = 0;
  std::size_t reading = 0;
  for (const SampleBlock& block : cut.blocks) {
    for (; reading < cut.readings.size() && cut.readings[reading].stamp_ns <= block.stamp_ns; ++reading)
      monitor->add_speed(cut.readings[reading]);
    const double now = static_cast<double>(block.stamp_ns - kOrigin_ns) * 1e-9;
    if (block.stamp_ns >= next_prior_ns) {
      next_prior_ns = block.stamp_ns + kPriorEvery_ns;
      const double depth = value_at(plan.schedule.axial_depth, now);
      const double margin = depth > 0.0 ? plan.map_limit / depth - 1.0 : kInfinity;
      if (!(std::abs(margin - told) <= kPriorStep)) monitor->expect(plan.map_modes, told = margin);
    }
    monitor->advance(block.stamp_ns);
    monitor->add_samples(block);
    collect(*monitor, alarms, open);
    monitor->clear_events();
    if (!open) continue;
    Alarm& alarm = alarms.back();
    const double heard_hz = monitor->view().chatter_frequency_hz;
    if (now >= alarm.time + 0.025 && std::isnan(alarm.after_25ms_hz)) alarm.after_25ms_hz = heard_hz;
    if (now >= alarm.time + 0.25 && std::isnan(alarm.after_250ms_hz)) alarm.after_250ms_hz = heard_hz;
  }
  return alarms;
}

}  // namespace stillcut::detection
