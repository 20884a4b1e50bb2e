#include "tools/export_mcap.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <nlohmann/json.hpp>

#include "tools/event_csv.hpp"
#include "tools/number_text.hpp"

namespace stillcut {
namespace {

// A JSON object, member after member; numbers that are none and empty texts are left out.
class JsonObject {
 public:
  explicit JsonObject(std::string& text) : text_{text} { text_ = "{"; }
  template <class Number>
  JsonObject& number(std::string_view key, Number value) {
    if (!std::isfinite(static_cast<double>(value))) return *this;
    name(key);
    append_number(text_, value);
    return *this;
  }
  JsonObject& yes_or_no(std::string_view key, bool value) {
    name(key);
    text_ += value ? "true" : "false";
    return *this;
  }
  JsonObject& text(std::string_view key, std::string_view value) {
    if (value.empty()) return *this;
    name(key);
    text_ += nlohmann::json(value).dump(-1, ' ', true, nlohmann::json::error_handler_t::replace);
    return *this;
  }
  // What is no number stands as null, to keep the others' places.
  template <class Numbers>
  JsonObject& numbers(std::string_view key, const Numbers& values) {
    name(key);
    text_ += '[';
    bool first = true;
    for (const auto value : values) {
      if (!std::exchange(first, false)) text_ += ',';
      if (std::isfinite(value))
        append_number(text_, value);
      else
        text_ += "null";
    }
    text_ += ']';
    return *this;
  }
  const std::string& end() { return text_ += '}'; }

 private:
  void name(std::string_view key) {
    if (text_.size() > 1) text_ += ',';
    text_.append("\"").append(key).append("\":");
  }
  std::string& text_;
};

struct SchemaMember {
  const char *name, *type, *description;
};

std::string schema_of(const char* title, std::initializer_list<SchemaMember> members) {
  nlohmann::ordered_json properties;
  for (const SchemaMember& member : members) {
    const std::string type = member.type;
    nlohmann::ordered_json property{{"type", type}};
    if (type == "array") property["items"] = {{"type", "number"}};
    property["description"] = member.description;
    properties[member.name] = property;
  }
  return nlohmann::ordered_json{{"$schema", "http://json-schema.org/draft-07/schema#"},
                                {"title", title},
                                {"type", "object"},
                                {"properties", properties}}
      .dump();
}

std::string vibration_schema() {
  return schema_of("Vibration", {{"time_s", "number", "of the first sample, since the recording's first frame"},
                                 {"sample_rate_hz", "number", "samples are 1/sample_rate_hz apart"},
                                 {"samples_missing", "integer", "lost just before the first sample"},
                                 {"peak_m_per_s2", "number", "largest sample of all axes, without sign"},
                                 {"x_m_per_s2", "array", "acceleration in tool axes, oldest first"},
                                 {"y_m_per_s2", "array", "acceleration in tool axes, oldest first"},
                                 {"z_m_per_s2", "array", "acceleration in tool axes, oldest first"}});
}

std::string spindle_schema() { return schema_of("Spindle", {{"speed_rpm", "number", "measured"}}); }

std::string event_schema() {
  return schema_of("Event", {{"event", "string", "cut_entry, cut_exit, chatter_onset, chatter_end, correction, ..."},
                             {"kind", "string", "of chatter: regenerative, structural, unknown"},
                             {"frequency_hz", "number", "of the chatter"},
                             {"indicator", "number", "1 is the alarm limit"},
                             {"spindle_speed_rpm", "number", "measured; in a correction the target"},
                             {"note", "string", "for people"}});
}

std::string correction_schema() {
  return schema_of("Correction", {{"sequence", "integer", "that an acknowledgement names"},
                                  {"valid_for_ms", "integer", "from receipt"},
                                  {"mode", "string", "shadow: shown only; active: to be followed"},
                                  {"kind", "string", "release, spindle_speed, speed_variation, ..."},
                                  {"spindle_speed_rpm", "number", "setpoint now"},
                                  {"spindle_speed_target_rpm", "number", "where the ramp ends"},
                                  {"speed_variation_ratio", "number", "amplitude over mean"},
                                  {"speed_variation_hz", "number", "of the variation"},
                                  {"feed_override", "number", "1: as programmed"},
                                  {"feed_direction_rad", "number", "workpiece XY, from +X toward +Y"},
                                  {"chatter_frequency_hz", "number", "that it answers"},
                                  {"predicted_margin_before", "number", "limit depth over depth, less 1"},
                                  {"predicted_margin_after", "number", "limit depth over depth, less 1"},
                                  {"limited_by", "integer", "bits, see correction_t.lcm"},
                                  {"confidence_percent", "integer", "0 to 100"},
                                  {"reason", "string", "for people"}});
}

std::string status_schema() {
  return schema_of("Status", {{"state", "string", "idle, air, entry, cut, exit, chatter, cannot_tell, fault"},
                              {"mode", "string", "off, shadow, active"},
                              {"spindle_speed_rpm", "number", "measured"},
                              {"indicator", "number", "1 is the alarm limit"},
                              {"margin", "number", "predicted"},
                              {"chatter_frequency_hz", "number", "while it chatters"},
                              {"frames", "integer", "of CAN so far"},
                              {"frames_lost", "integer", "so far, by the sensors' counters"}});
}

std::string robot_state_schema() {
  return schema_of("RobotState", {{"joint_position_rad", "array", "six axes"},
                                  {"tcp_position_m", "array", "workpiece frame"},
                                  {"tool_orientation_wxyz", "array", "workpiece to tool"},
                                  {"feed_direction_rad", "number", "workpiece XY, from +X toward +Y"},
                                  {"feed_rate_m_per_s", "number", "along the path"},
                                  {"spindle_speed_rpm", "number", "commanded"},
                                  {"axial_depth_m", "number", "where the controller knows it"},
                                  {"radial_depth_m", "number", "where the controller knows it"},
                                  {"milling", "integer", "0 unknown, 1 down, 2 up, 3 slot"},
                                  {"block", "integer", "of the program"}});
}

std::string robot_ack_schema() {
  return schema_of("RobotAck", {{"sequence", "integer", "of the correction"},
                                {"accepted", "boolean", "false: refused"},
                                {"spindle_speed_rpm", "number", "that the controller now runs"},
                                {"feed_override", "number", "that the controller now runs"},
                                {"reason", "string", "why it was refused"}});
}

// Of an enumeration that counts from 0.
template <std::size_t N, class Enum>
std::string_view name_in(const std::array<std::string_view, N>& names, Enum value) {
  const auto place = static_cast<std::size_t>(value);
  return place < N ? names[place] : std::string_view{"unknown"};
}
constexpr std::array<std::string_view, 3> kModeNames{"off", "shadow", "active"};
constexpr std::array<std::string_view, 8> kStateNames{"idle", "air",     "entry",       "cut",
                                                      "exit", "chatter", "cannot_tell", "fault"};
constexpr std::array<std::string_view, 6> kCorrectionNames{"release",        "spindle_speed", "speed_variation",
                                                           "feed_direction", "feed_override", "stop_request"};

}  // namespace

McapExport::McapExport(std::ostream& out, std::span<const AccelerometerSettings> sensors)
    : writer_{out, "stillcut " STILLCUT_VERSION},
      spindle_{writer_.add_channel("/spindle", "stillcut.Spindle", spindle_schema())},
      event_{writer_.add_channel("/events", "stillcut.Event", event_schema())},
      correction_{writer_.add_channel("/corrections", "stillcut.Correction", correction_schema())},
      status_{writer_.add_channel("/status", "stillcut.Status", status_schema())},
      robot_state_{writer_.add_channel("/robot_state", "stillcut.RobotState", robot_state_schema())},
      robot_ack_{writer_.add_channel("/robot_ack", "stillcut.RobotAck", robot_ack_schema())} {
  for (std::size_t s = 0; s < sensors.size(); ++s)
    vibration_.push_back(
        writer_.add_channel("/vibration/sensor_" + std::to_string(s + 1), "stillcut.Vibration", vibration_schema()));
}

void McapExport::add(const SampleStretch& stretch, std::int64_t origin_ns) {
  static constexpr std::array<const char*, kMaxAxes> kKeys{"x_m_per_s2", "y_m_per_s2", "z_m_per_s2"};
  const double first_s = stretch.begin_s + static_cast<double>(stretch.missing) * stretch.step_s;
  float peak = 0.0F;
  for (const auto& axis : stretch.axis)
    for (const float value : axis)
      if (std::isfinite(value)) peak = std::max(peak, std::abs(value));
  JsonObject json{json_};
  json.number("time_s", first_s).number("sample_rate_hz", 1.0 / stretch.step_s);
  json.number("samples_missing", stretch.missing).number("peak_m_per_s2", peak);
  for (std::size_t a = 0; a < kMaxAxes; ++a)
    if (!stretch.axis[a].empty()) json.numbers(kKeys[a], stretch.axis[a]);
  writer_.write(vibration_.at(static_cast<std::size_t>(stretch.sensor)), origin_ns + std::llround(first_s * 1e9),
                json.end());
}

void McapExport::add(const SpindleReading& reading) {
  writer_.write(spindle_, reading.stamp_ns, JsonObject{json_}.number("speed_rpm", rad_s_to_rpm(reading.speed)).end());
}

void McapExport::add(const Output& output) {
  JsonObject json{json_};
  if (output.type == Output::Type::event) {
    const Event& event = output.event;
    json.text("event", event_name(event.type)).text("kind", kind_name(event));
    json.number("frequency_hz", event.frequency_hz).number("indicator", event.indicator);
    json.number("spindle_speed_rpm", event.spindle_speed_rpm).text("note", event.note.data());
    writer_.write(event_, event.stamp_ns, json.end());
  } else if (output.type == Output::Type::correction) {
    const Correction& c = output.correction;
    json.number("sequence", c.sequence).number("valid_for_ms", c.valid_for_ms);
    json.text("mode", name_in(kModeNames, c.mode)).text("kind", name_in(kCorrectionNames, c.kind));
    json.number("spindle_speed_rpm", c.spindle_speed_rpm);
    json.number("spindle_speed_target_rpm", c.spindle_speed_target_rpm);
    json.number("speed_variation_ratio", c.speed_variation_ratio).number("speed_variation_hz", c.speed_variation_hz);
    json.number("feed_override", c.feed_override).number("feed_direction_rad", c.feed_direction);
    json.number("chatter_frequency_hz", c.chatter_frequency_hz);
    json.number("predicted_margin_before", c.predicted_margin_before);
    json.number("predicted_margin_after", c.predicted_margin_after).number("limited_by", c.limited_by);
    json.number("confidence_percent", int{c.confidence_percent}).text("reason", c.reason.data());
    writer_.write(correction_, c.stamp_ns, json.end());
  } else {
    const Status& s = output.status;
    json.text("state", name_in(kStateNames, s.state)).text("mode", name_in(kModeNames, s.mode));
    json.number("spindle_speed_rpm", s.spindle_speed_rpm).number("indicator", s.indicator).number("margin", s.margin);
    json.number("chatter_frequency_hz", s.chatter_frequency_hz);
    json.number("frames", s.frames).number("frames_lost", s.frames_lost);
    writer_.write(status_, s.stamp_ns, json.end());
  }
}

void McapExport::add(const RobotMessage& message) {
  JsonObject json{json_};
  if (const auto* state = std::get_if<RobotState>(&message)) {
    json.numbers("joint_position_rad", state->joint_position).numbers("tcp_position_m", state->tcp_position);
    json.numbers("tool_orientation_wxyz", state->tool_orientation);
    json.number("feed_direction_rad", state->feed_direction).number("feed_rate_m_per_s", state->feed_rate);
    json.number("spindle_speed_rpm", state->spindle_speed_rpm).number("axial_depth_m", state->axial_depth);
    json.number("radial_depth_m", state->radial_depth).number("milling", static_cast<int>(state->milling));
    json.number("block", state->block);
    writer_.write(robot_state_, state->stamp_ns, json.end());
  } else if (const auto* ack = std::get_if<CorrectionAck>(&message)) {
    json.number("sequence", ack->sequence).yes_or_no("accepted", ack->accepted);
    json.number("spindle_speed_rpm", ack->spindle_speed_rpm).number("feed_override", ack->feed_override);
    json.text("reason", ack->reason.data());
    writer_.write(robot_ack_, ack->stamp_ns, json.end());
  }
}

}  // namespace stillcut
