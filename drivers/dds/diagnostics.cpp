#include "drivers/dds/diagnostics.hpp"

#include <array>
#include <cstdio>

#include "dsp/integrity.hpp"

namespace stillcut {
namespace {

using Item = diagnostic_msgs::msg::dds_::DiagnosticStatus_;
using Value = diagnostic_msgs::msg::dds_::KeyValue_;

enum Level : std::uint8_t { kOk = 0, kWarn = 1, kError = 2, kStale = 3 };

// The worst that was said of an item wins, the first of equals.
class ItemBuilder {
 public:
  ItemBuilder(const std::string& name, const char* part, const std::string& hardware_id) {
    item_.name(name + ": " + part);
    item_.hardware_id(hardware_id);
    item_.level(kOk);
    item_.message("ok");
  }
  void say(Level level, const std::string& message) {
    if (level < item_.level() || (level == item_.level() && said_)) return;
    said_ = true;
    item_.level(level);
    item_.message(message);
  }
  void value(const std::string& key, std::int64_t count) { add(key, std::to_string(count)); }
  void value(const std::string& key, double quantity) {
    std::array<char, 32> text{};
    (void)std::snprintf(text.data(), text.size(), "%.6g", quantity);
    add(key, text.data());
  }
  // A count of what should not happen; it warns when it has risen.
  void loss(const std::string& key, std::int64_t count, std::int64_t before) {
    value(key, count);
    if (count > before) say(kWarn, key + " rose by " + std::to_string(count - before));
  }
  void text(const std::string& key, const std::string& value) { add(key, value); }
  Item item() { return std::move(item_); }

 private:
  void add(const std::string& key, const std::string& text) {
    Value value;
    value.key(key);
    value.value(text);
    item_.values().push_back(std::move(value));
  }

  Item item_;
  bool said_ = false;
};

constexpr const char* kSilent = "nothing is heard of the monitor; is stillcutd running with this cell?";

void fill_monitor(ItemBuilder& item, const Status& status, const std::optional<MonitorReport>& report) {
  const std::uint32_t doubts = report ? report->doubts : std::uint32_t{kNoDoubt};
  switch (status.state) {
    case State::fault:
      item.say(kError, describe(status.state));
      break;
    case State::chatter:
    case State::cannot_tell:
      item.say(kWarn, describe(status.state));
      break;
    default:
      item.say(kOk, describe(status.state));
  }
  static constexpr std::array kModes{"off", "shadow", "active"};
  item.text("corrections", kModes.at(static_cast<std::size_t>(status.mode)));
  item.value("indicator", status.indicator);
  item.value("spindle speed (rpm)", status.spindle_speed_rpm);
  item.value("chatter frequency (Hz)", status.chatter_frequency_hz);
  item.value("predicted margin", status.margin);
  item.value("frames", status.frames);
  item.value("doubts (bits)", std::int64_t{doubts});
}

void fill_sensors(ItemBuilder& item, const HealthReport& health, const HealthReport& before) {
  for (int bit = 0; bit < kDoubtCount; ++bit) {
    const auto doubt = static_cast<Doubt>(1U << static_cast<unsigned>(bit));
    if ((health.doubts & doubt) != 0) item.say(doubt == kSensorSilent ? kError : kWarn, describe(doubt));
  }
  for (std::size_t i = 0; i < health.sensors.size(); ++i) {
    const SensorHealth &sensor = health.sensors[i], old = i < before.sensors.size() ? before.sensors[i] : sensor;
    const std::string of = "accelerometer " + std::to_string(i) + ' ';
    item.value(of + "nominal rate (Hz)", sensor.nominal_rate_hz);
    item.value(of + "rate (Hz)", sensor.rate_hz);
    item.loss(of + "lost frames", sensor.lost, old.lost);
    item.loss(of + "gaps", sensor.gaps, old.gaps);
    item.loss(of + "saturated samples", sensor.saturated, old.saturated);
    item.loss(of + "samples not finite", sensor.not_finite, old.not_finite);
  }
}

void fill_bus(ItemBuilder& item, const HealthReport& health, const HealthReport& before) {
  static constexpr std::array kStates{"up", "down", "gone", "ended"};
  const auto which = static_cast<std::size_t>(health.bus_state);
  const char* state = which < kStates.size() ? kStates[which] : "unknown";
  const bool lost = health.bus_state == 1 || health.bus_state == 2;
  item.say(lost ? kError : kOk, std::string("the bus is ") + state);
  item.text("state", state);
  item.value("frames", health.frames);
  item.loss("dropped by the kernel", health.kernel_dropped, before.kernel_dropped);
  item.loss("error frames", health.error_frames, before.error_frames);
  item.loss("bus-off", health.bus_off, before.bus_off);
  item.loss("reopened", health.reopened, before.reopened);
  item.loss("bad frames", health.frames_bad, before.frames_bad);
  item.loss("lost frames", health.frames_lost, before.frames_lost);
  item.loss("frames out of order", health.frames_out_of_order, before.frames_out_of_order);
  item.loss("bad messages of the robot", health.messages_bad, before.messages_bad);
}

void fill_loop(ItemBuilder& item, const LatencyReport& latency, const LatencyReport& before) {
  item.say(latency.in_time ? kOk : kError, latency.in_time ? "in time" : "out of time");
  item.value("ticks", latency.ticks);
  item.loss("overruns", latency.overruns, before.overruns);
  item.loss("wake-ups left out", latency.skipped, before.skipped);
  item.loss("times out of time", latency.times_out, before.times_out);
  for (const LatencyReport::Stage& stage : latency.stages) {
    item.value(stage.name + " p99 (us)", stage.p99_us);
    item.value(stage.name + " max (us)", stage.max_us);
  }
}

void fill_hand_over(ItemBuilder& item, const HealthReport& health, const HealthReport& before) {
  item.loss("outputs dropped", health.outputs_dropped, before.outputs_dropped);
  item.loss("records dropped", health.record_dropped, before.record_dropped);
  item.loss("telemetry dropped", health.telemetry_dropped, before.telemetry_dropped);
  item.loss("messages not published", health.publish_failed, before.publish_failed);
}

}  // namespace

const char* describe(State state) noexcept {
  switch (state) {
    case State::idle:
      return "idle";
    case State::air:
      return "air";
    case State::entry:
      return "entry";
    case State::cut:
      return "cut";
    case State::exit:
      return "exit";
    case State::chatter:
      return "chatter";
    case State::cannot_tell:
      return "cannot tell";
    case State::fault:
      return "fault";
  }
  return "unknown";
}

void Diagnostics::hear(const TelemetryMessage& message, std::int64_t heard_ns) {
  if (const auto* status = std::get_if<Status>(&message)) status_.hear(*status, heard_ns);
  if (const auto* health = std::get_if<HealthReport>(&message)) health_.hear(*health, heard_ns);
  if (const auto* latency = std::get_if<LatencyReport>(&message)) latency_.hear(*latency, heard_ns);
  if (const auto* report = std::get_if<MonitorReport>(&message)) monitor_ = *report;
}

DiagnosticsSample Diagnostics::sample(std::int64_t now_ns, std::int64_t stamp_ns) {
  DiagnosticsSample array;
  array.header(header_sample(stamp_ns));
  const auto add = [&](const char* part, const auto& heard, const auto& fill) {
    ItemBuilder item{name_, part, hardware_id_};
    if (heard.stale(now_ns)) item.say(kStale, kSilent);
    if (heard.now) fill(item, *heard.now, heard.reported);
    array.status().push_back(item.item());
  };
  add("monitor", status_,
      [&](ItemBuilder& item, const Status& now, const Status&) { fill_monitor(item, now, monitor_); });
  add("sensors", health_, fill_sensors);
  add("bus", health_, fill_bus);
  add("loop", latency_, [&](ItemBuilder& item, const LatencyReport& now, const LatencyReport& before) {
    fill_loop(item, now, before);
    if (health_.now) fill_hand_over(item, *health_.now, health_.reported);
  });
  if (health_.now) health_.reported = *health_.now;
  if (latency_.now) latency_.reported = *latency_.now;
  return array;
}

}  // namespace stillcut
