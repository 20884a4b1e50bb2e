#include "tools/cell_json.hpp"

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "tools/event_csv.hpp"
#include "tools/spoken.hpp"

namespace stillcut {
namespace {

using Json = nlohmann::ordered_json;

// Seven digits are more than anyone sees.
double seven_digits(double value) {
  if (value == 0.0) return 0.0;
  const double scale = std::pow(10.0, 6.0 - std::floor(std::log10(std::abs(value))));
  return std::round(value * scale) / scale;
}

Json number_json(double value, double scale = 1.0) {
  return std::isfinite(value) ? Json(seven_digits(scale * value)) : Json(nullptr);
}
Json text_json(const ShortText& text) { return std::string(text_of(text)); }
double since(std::int64_t stamp_ns, std::int64_t origin_ns) {
  const std::int64_t us = (stamp_ns - origin_ns) / 1000;
  return static_cast<double>(us) / 1e6;  // divided: the shortest decimals
}

constexpr double kDegrees = 180.0 / std::numbers::pi;

std::string base64(std::span<const std::uint8_t> bytes) {
  static constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t three = 0;
    for (std::size_t k = 0; k < 3; ++k) three = three << 8 | (k < count ? bytes[i + k] : 0U);
    for (std::size_t k = 0; k < 4; ++k) text += k <= count ? kDigits[three >> (18 - 6 * k) & 63U] : '=';
  }
  return text;
}

// What is asked for just now, or nulls.
void add_advice(Json& json, const Correction* asked) {
  json["advised_rpm"] = asked == nullptr ? Json(nullptr) : number_json(asked->spindle_speed_target_rpm);
  json["advice"] = asked == nullptr ? Json(nullptr) : Json(correction_name(asked->kind));
  json["limited_by"] = asked == nullptr ? Json::array() : Json(limits_reached(asked->limited_by));
  json["advice_reason"] = asked == nullptr ? Json(nullptr) : text_json(asked->reason);
  json["advised_direction_deg"] = asked == nullptr ? Json(nullptr) : number_json(asked->feed_direction, kDegrees);
  json["feed_override"] = asked == nullptr ? Json(nullptr) : number_json(asked->feed_override);
  json["variation_ratio"] = asked == nullptr ? Json(nullptr) : number_json(asked->speed_variation_ratio);
  json["variation_hz"] = asked == nullptr ? Json(nullptr) : number_json(asked->speed_variation_hz);
}

}  // namespace

Json state_json(const CellView& view, const ShownState& state, std::int64_t time_ns, std::int64_t origin_ns) {
  const MonitorReport monitor = view.monitor().value_or(MonitorReport{});
  Json json{{"t", since(time_ns, origin_ns)},
            {"state", shown_name(state.shown)},
            {"reason", state.reason},
            {"mode", mode_name(monitor.mode)},
            {"rpm", number_json(monitor.spindle_speed_rpm)}};
  add_advice(json, view.asked());
  json["indicator"] = number_json(monitor.indicator);
  json["margin"] = number_json(monitor.margin);
  json["depth_mm"] = number_json(monitor.axial_depth, 1e3);
  json["limit_mm"] = number_json(monitor.depth_limit, 1e3);
  json["chatter_hz"] = number_json(monitor.chatter_frequency_hz);
  json["chatter_kind"] = monitor.chatter ? Json(chatter_name(monitor.kind)) : Json(nullptr);
  json["mode_number"] = monitor.chatter_mode > 0 ? Json(monitor.chatter_mode) : Json(nullptr);
  json["mode_hz"] = number_json(monitor.chatter_mode_hz);
  return json;
}

Json spectrum_json(const SpectrumReport& report, std::int64_t origin_ns) {
  return {{"t", since(report.stamp_ns, origin_ns)},
          {"sensor", report.sensor},
          {"bin_hz", report.bin_hz},
          {"low_db", report.low_db},
          {"step_db", report.step_db},
          {"levels", base64(report.levels)},
          {"spindle_hz", number_json(report.spindle_hz)},
          {"tooth_hz", report.teeth > 0 ? number_json(report.spindle_hz, report.teeth) : Json(nullptr)}};
}

Json lobes_json(const DiagramReport& report, std::int64_t origin_ns) {
  Json rpm = Json::array(), limit = Json::array(), modes = Json::array();
  const std::size_t points = report.depth_limit_mm.size();
  const double step = points > 1 ? (report.max_rpm - report.min_rpm) / static_cast<double>(points - 1) : 0.0;
  for (std::size_t i = 0; i < points; ++i) {
    const auto limit_mm = static_cast<double>(report.depth_limit_mm[i]);
    rpm.push_back(seven_digits(report.min_rpm + step * static_cast<double>(i)));
    // Without bound: null; unstable at every depth: none is allowed.
    limit.push_back(std::isnan(limit_mm) ? Json(0.0) : number_json(limit_mm));
  }
  for (std::size_t i = 0; i < report.mode_hz.size(); ++i)
    modes.push_back({{"hz", seven_digits(report.mode_hz[i])}, {"damping_ratio", seven_digits(report.mode_damping[i])}});
  return {{"t", since(report.stamp_ns, origin_ns)},
          {"valid", report.valid},
          {"rpm", std::move(rpm)},
          {"limit_mm", std::move(limit)},
          {"modes", std::move(modes)}};
}

Json event_json(const Event& event, std::int64_t origin_ns) {
  return {{"t", since(event.stamp_ns, origin_ns)},
          {"event", event_name(event.type)},
          {"kind", kind_name(event)},
          {"hz", number_json(event.frequency_hz)},
          {"indicator", number_json(event.indicator)},
          {"rpm", number_json(event.spindle_speed_rpm)},
          {"note", text_json(event.note)}};
}

Json correction_json(const Correction& correction, std::int64_t origin_ns) {
  return {{"t", since(correction.stamp_ns, origin_ns)},
          {"sequence", correction.sequence},
          {"mode", mode_name(correction.mode)},
          {"kind", correction_name(correction.kind)},
          {"rpm_target", number_json(correction.spindle_speed_target_rpm)},
          {"rpm_setpoint", number_json(correction.spindle_speed_rpm)},
          {"feed_override", number_json(correction.feed_override)},
          {"feed_direction_deg", number_json(correction.feed_direction, kDegrees)},
          {"chatter_hz", number_json(correction.chatter_frequency_hz)},
          {"margin_before", number_json(correction.predicted_margin_before)},
          {"margin_after", number_json(correction.predicted_margin_after)},
          {"limited_by", limits_reached(correction.limited_by)},
          {"confidence_percent", static_cast<int>(correction.confidence_percent)},
          {"reason", text_json(correction.reason)}};
}

std::vector<Hop> hops_of(const HealthReport& report) {
  return {{"CAN, dropped by the kernel", "kernel", report.kernel_dropped},
          {"CAN, error frames", "bus_errors", report.error_frames},
          {"sensor to bus, by its counter", "sensor", report.frames_lost},
          {"decoder, bad frames", "decoder", report.frames_bad},
          {"core, frames out of order", "core", report.frames_out_of_order},
          {"robot, bad messages", "robot", report.messages_bad},
          {"loop to publisher", "publisher_ring", report.outputs_dropped},
          {"loop to recorder", "recorder_ring", report.record_dropped},
          {"loop to telemetry", "telemetry_ring", report.telemetry_dropped},
          {"LCM, not sent", "lcm", report.publish_failed}};
}

Json health_json(const HealthReport& report, std::int64_t origin_ns) {
  Json sensors = Json::array(), hops = Json::array();
  for (const SensorHealth& sensor : report.sensors) {
    const double error = 100.0 * (sensor.rate_hz / sensor.nominal_rate_hz - 1.0);
    sensors.push_back({{"name", "accelerometer " + std::to_string(sensors.size() + 1)},
                       {"wanted_hz", number_json(sensor.nominal_rate_hz)},
                       {"rate_hz", number_json(sensor.rate_hz)},
                       {"rate_error_percent", number_json(error)},
                       {"frames_lost", sensor.lost},
                       {"gaps", sensor.gaps},
                       {"saturated", sensor.saturated},
                       {"not_finite", sensor.not_finite}});
  }
  for (const Hop& hop : hops_of(report)) hops.push_back({{"hop", hop.name}, {"lost", hop.lost}});
  return {{"t", since(report.stamp_ns, origin_ns)},
          {"frames", report.frames},
          {"bus_off", report.bus_off},
          {"reopened", report.reopened},
          {"sensors", std::move(sensors)},
          {"doubts", doubt_names(report.doubts)},
          {"hops", std::move(hops)}};
}

Json latency_json(const LatencyReport& report, const HistogramReport* histogram, std::int64_t origin_ns) {
  Json stages = Json::array(), histograms = Json::array();
  for (const LatencyReport::Stage& stage : report.stages)
    stages.push_back({{"stage", stage.name},
                      {"count", stage.count},
                      {"p50_us", stage.p50_us},
                      {"p99_us", stage.p99_us},
                      {"p999_us", stage.p999_us},
                      {"max_us", stage.max_us}});
  const auto add = [&](const char* stage, const HistogramReport::Counts& counts) {
    histograms.push_back({{"stage", stage},
                          {"first_us", HistogramReport::kFirst_us},
                          {"per_octave", HistogramReport::kPerOctave},
                          {"counts", counts}});
  };
  if (histogram != nullptr) {
    add("decision", histogram->decision);
    add("tick", histogram->tick);
    add("wake-up", histogram->wake_up);
  }
  return {{"t", since(report.stamp_ns, origin_ns)},
          {"in_time", report.in_time},
          {"times_out", report.times_out},
          {"stages", std::move(stages)},
          {"histograms", std::move(histograms)}};
}

}  // namespace stillcut
