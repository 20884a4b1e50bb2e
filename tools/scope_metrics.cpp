#include "tools/scope_metrics.hpp"

#include <array>
#include <cmath>
#include <cstdio>

#include "tools/cell_json.hpp"
#include "tools/event_csv.hpp"

namespace stillcut {
namespace {

std::string escaped_label(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '\\' || c == '"') out += '\\';
    out += c == '\n' ? ' ' : c;
  }
  return out;
}

class MetricsText {
 public:
  explicit MetricsText(const std::string& cell) : cell_{"cell=\"" + escaped_label(cell) + '"'} {}

  void begin(const char* name, const char* type, const char* help) {
    name_ = name;
    text_ += std::string("# HELP ") + name + ' ' + help + "\n# TYPE " + name + ' ' + type + '\n';
  }
  // What is unknown has no sample.
  void add(double value, const std::string& labels = {}) {
    if (std::isnan(value)) return;
    std::array<char, 64> number{};
    std::snprintf(number.data(), number.size(), "%.10g", value);
    const std::string shown = std::isinf(value) ? (value > 0 ? "+Inf" : "-Inf") : number.data();
    text_ += name_ + '{' + cell_ + (labels.empty() ? "" : ',' + labels) + "} " + shown + '\n';
  }
  void add(const char* name, const char* type, const char* help, double value) {
    begin(name, type, help);
    add(value);
  }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  std::string cell_, name_, text_;
};

void add_health(MetricsText& out, const HealthReport& health) {
  const auto count = [](std::int64_t n) { return static_cast<double>(n); };
  out.add("stillcut_can_frames_total", "counter", "CAN frames that the core accepted.", count(health.frames));
  out.begin("stillcut_lost_total", "counter", "Frames and messages lost, by hop.");
  for (const Hop& hop : hops_of(health)) out.add(count(hop.lost), std::string("hop=\"") + hop.metric + '"');
  out.add("stillcut_can_bus_off_total", "counter", "Times that the CAN controller was bus-off.", count(health.bus_off));
  out.add("stillcut_can_bus_up", "gauge", "1: the CAN interface is up.", health.bus_state == 0 ? 1.0 : 0.0);
  const auto each = [&](const char* name, const char* type, const char* help, auto&& value) {
    out.begin(name, type, help);
    for (std::size_t i = 0; i < health.sensors.size(); ++i)
      out.add(value(health.sensors[i]), "sensor=\"" + std::to_string(i + 1) + '"');
  };
  each("stillcut_sensor_rate_hz", "gauge", "Sample rate measured by the frames' stamps, Hz.",
       [](const SensorHealth& s) { return s.rate_hz; });
  each("stillcut_sensor_gaps_total", "counter", "Times that frames of a sensor were lost.",
       [&](const SensorHealth& s) { return count(s.gaps); });
  each("stillcut_sensor_saturated_samples_total", "counter", "Samples at the end of the sensor's range.",
       [&](const SensorHealth& s) { return count(s.saturated); });
}

void add_latency(MetricsText& out, const LatencyReport& latency) {
  out.add("stillcut_loop_ticks_total", "counter", "Ticks of the real-time loop.", static_cast<double>(latency.ticks));
  out.add("stillcut_loop_overruns_total", "counter", "Ticks that ended when the next was due.",
          static_cast<double>(latency.overruns));
  out.add("stillcut_loop_in_time", "gauge", "1: the loop keeps time.", latency.in_time ? 1.0 : 0.0);
  out.begin("stillcut_loop_latency_seconds", "gauge", "Times of the loop's stages since its start, by quantile.");
  for (const LatencyReport::Stage& stage : latency.stages) {
    const std::string label = "stage=\"" + escaped_label(stage.name) + "\",quantile=";
    out.add(1e-6 * stage.p50_us, label + "\"0.5\"");
    out.add(1e-6 * stage.p99_us, label + "\"0.99\"");
    out.add(1e-6 * stage.p999_us, label + "\"0.999\"");
    out.add(1e-6 * stage.max_us, label + "\"1\"");
  }
}

}  // namespace

std::string prometheus_text(const CellView& view, const std::string& cell, std::int64_t now_ns) {
  MetricsText out{cell};
  const ShownState state = view.state(now_ns);
  out.add("stillcut_up", "gauge", "1: the daemon is heard.", state.shown == Shown::no_daemon ? 0.0 : 1.0);
  out.begin("stillcut_state", "gauge", "1 for the state shown, 0 for the others.");
  for (int s = 0; s <= static_cast<int>(Shown::fault); ++s)
    out.add(s == static_cast<int>(state.shown) ? 1.0 : 0.0,
            std::string("state=\"") + shown_name(static_cast<Shown>(s)) + '"');
  if (const auto& monitor = view.monitor(); monitor && state.shown != Shown::no_daemon) {
    out.add("stillcut_indicator", "gauge", "Chatter indicator, 1 is the alarm limit.", monitor->indicator);
    out.add("stillcut_spindle_speed_rpm", "gauge", "Measured spindle speed, rpm.", monitor->spindle_speed_rpm);
    out.add("stillcut_margin_ratio", "gauge", "Predicted depth limit over depth, less 1.", monitor->margin);
    out.add("stillcut_axial_depth_meters", "gauge", "Axial depth of cut, m.", monitor->axial_depth);
    out.add("stillcut_depth_limit_meters", "gauge", "Predicted depth limit at this speed, m.", monitor->depth_limit);
    out.add("stillcut_chatter_frequency_hz", "gauge", "Frequency of chatter, Hz; absent without.",
            monitor->chatter_frequency_hz);
    const Correction* asked = view.asked();
    out.add("stillcut_advised_speed_rpm", "gauge", "Spindle speed asked for, rpm; absent where none is.",
            asked == nullptr ? kNaN : asked->spindle_speed_target_rpm);
  }
  out.begin("stillcut_events_total", "counter", "Events heard by this server, by kind.");
  for (int type = 1; type <= 7; ++type)
    out.add(static_cast<double>(view.events_heard(static_cast<EventType>(type))),
            "event=\"" + std::string(event_name(static_cast<EventType>(type))) + '"');
  if (view.health()) add_health(out, *view.health());
  if (view.latency()) add_latency(out, *view.latency());
  return out.text();
}

}  // namespace stillcut
