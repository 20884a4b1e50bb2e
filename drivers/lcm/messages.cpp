#include "drivers/lcm/messages.hpp"

#include <algorithm>
#include <cmath>
#include <stillcut/correction_ack_t.hpp>
#include <stillcut/correction_t.hpp>
#include <stillcut/event_t.hpp>
#include <stillcut/robot_path_t.hpp>
#include <stillcut/robot_state_t.hpp>
#include <stillcut/status_t.hpp>
#include <string>

#include "drivers/lcm/message_bytes.hpp"

namespace stillcut {
namespace {

constexpr std::int64_t kUsPerMs = 1000;

// Beyond these no machine moves: such a message is a fault of the sender.
constexpr double kMaxJointRad = 1e3, kMaxPositionM = 1e3, kMaxAngleRad = 1e3, kMaxFeedMPerS = 100, kMaxSpeedRpm = 1e6,
                 kMaxDepthM = 1.0, kMaxOverride = 10.0;
constexpr double kShortestOrientation = 1e-3, kLongestOrientation = 1e3;
constexpr double kUnitTolerance = 1e-9;  // a squared length nearer to 1 is left bit for bit

constexpr std::size_t kLargestMessage = 1 << 20;  // of our types; with a long reason they have a few hundred bytes

constexpr const char* kWrongType =
    "the bytes are no message of this type; is the sender built from the same .lcm files?";
constexpr const char* kBadTime = "utime is out of range";

bool within(double value, double min, double max) { return value >= min && value <= max; }  // false for NaN
template <class Range>
bool all_within(const Range& values, double min, double max) {
  for (const double value : values) {
    if (!within(value, min, max)) return false;
  }
  return true;
}
bool unknown_or_within(double value, double min, double max) { return std::isnan(value) || within(value, min, max); }

// A text is the last field of every type that has one: its length (four bytes, the terminating zero counted) must lead
// exactly to the message's end. The generated code does not check a length below 1.
template <class Message>
bool text_fits(std::span<const std::uint8_t> bytes, const Message& empty) {
  constexpr std::size_t kLengthBytes = 4, kTerminator = 1;
  const auto text_at = static_cast<std::size_t>(empty.getEncodedSize()) - kTerminator;
  if (bytes.size() < text_at + kTerminator) return false;
  return text_at + count_at(bytes, text_at - kLengthBytes) == bytes.size();
}

// False when the bytes are of another type, cut short or too long. `message` comes as its default.
template <class Message>
bool from_bytes(std::span<const std::uint8_t> bytes, Message& message) {
  constexpr bool kHasText = requires { message.reason; }
  || requires { message.note; };
  if (bytes.size() > kLargestMessage) return false;
  if (kHasText && !text_fits(bytes, message)) return false;
  return decode_whole(bytes, message);
}

template <class T>
Received<T> refused(const char* why_not) {
  return {T{}, why_not};
}

const char* reason_to_refuse(const robot_state_t& m) {
  if (!all_within(m.joint_position_rad, -kMaxJointRad, kMaxJointRad)) return "joint_position_rad is no angle";
  if (!all_within(m.tcp_position_m, -kMaxPositionM, kMaxPositionM)) return "tcp_position_m is no place within 1 km";
  if (!all_within(m.tool_orientation_wxyz, -kLongestOrientation, kLongestOrientation)) {
    return "tool_orientation_wxyz is no quaternion";
  }
  if (!within(m.feed_direction_rad, -kMaxAngleRad, kMaxAngleRad)) return "feed_direction_rad is no angle";
  if (!within(m.feed_rate_m_per_s, 0, kMaxFeedMPerS)) return "feed_rate_m_per_s is not a number from 0 to 100";
  if (!within(m.spindle_speed_rpm, 0, kMaxSpeedRpm)) return "spindle_speed_rpm is not a number from 0 to 1e6";
  if (!unknown_or_within(m.axial_depth_m, 0, kMaxDepthM)) return "axial_depth_m is neither NaN nor from 0 to 1";
  if (!unknown_or_within(m.radial_depth_m, 0, kMaxDepthM)) return "radial_depth_m is neither NaN nor from 0 to 1";
  if (m.milling < 0 || m.milling > 3) return "milling is not 0, 1, 2 or 3";
  return nullptr;
}

const char* reason_to_refuse(const robot_path_t& m) {
  constexpr double kLongest_s = 3600.0;
  double before = 0.0;
  for (std::size_t i = 0; i < m.after_s.size(); ++i) {
    if (!within(m.after_s[i], before, kLongest_s)) return "after_s does not rise from 0 to 3600";
    before = m.after_s[i];
    if (!all_within(m.joint_position_rad[i], -kMaxJointRad, kMaxJointRad)) return "joint_position_rad is no angle";
    if (!all_within(m.tcp_position_m[i], -kMaxPositionM, kMaxPositionM))
      return "tcp_position_m is no place within 1 km";
    if (!within(m.feed_direction_rad[i], -kMaxAngleRad, kMaxAngleRad)) return "feed_direction_rad is no angle";
    if (!unknown_or_within(m.radial_depth_m[i], 0, kMaxDepthM)) return "radial_depth_m is neither NaN nor from 0 to 1";
    if (m.milling[i] < 0 || m.milling[i] > 3) return "milling is not 0, 1, 2 or 3";
  }
  return nullptr;
}

bool count_fits(std::span<const std::uint8_t> bytes) {
  constexpr std::size_t kFingerprint = 8, kTime = 8, kCount = 4;
  constexpr std::size_t kPoint = 8 * (1 + 6 + 3 + 1 + 1) + 1;
  if (bytes.size() < kFingerprint + kTime + kCount) return false;
  const std::size_t count = count_at(bytes, kFingerprint + kTime);
  return count <= RobotPath::kMaxPoints && bytes.size() == kFingerprint + kTime + kCount + count * kPoint;
}

const char* reason_to_refuse(const correction_ack_t& m) {
  if (m.sequence < 0) return "sequence is negative";
  if (m.accepted != 0 && m.accepted != 1) return "accepted is neither 0 nor 1";
  if (!within(m.spindle_speed_rpm, 0, kMaxSpeedRpm)) return "spindle_speed_rpm is not a number from 0 to 1e6";
  if (!within(m.feed_override, 0, kMaxOverride)) return "feed_override is not a number from 0 to 10";
  return nullptr;
}

}  // namespace

MessageBytes encode(const RobotState& state) {
  robot_state_t m{};
  m.utime = to_us(state.stamp_ns);
  std::copy(state.joint_position.begin(), state.joint_position.end(), m.joint_position_rad);
  std::copy(state.tcp_position.begin(), state.tcp_position.end(), m.tcp_position_m);
  std::copy(state.tool_orientation.begin(), state.tool_orientation.end(), m.tool_orientation_wxyz);
  m.feed_direction_rad = state.feed_direction;
  m.feed_rate_m_per_s = state.feed_rate;
  m.spindle_speed_rpm = state.spindle_speed_rpm;
  m.axial_depth_m = state.axial_depth;
  m.radial_depth_m = state.radial_depth;
  m.milling = static_cast<std::int8_t>(state.milling);
  m.block = state.block;
  return to_bytes(m);
}

MessageBytes encode(const RobotPath& path) {
  robot_path_t m{};
  m.utime = to_us(path.stamp_ns);
  m.count = static_cast<std::int32_t>(path.count);
  for (const PathPoint& point : std::span{path.points}.first(path.count)) {
    m.after_s.push_back(point.after);
    m.joint_position_rad.emplace_back(point.joint_position.begin(), point.joint_position.end());
    m.tcp_position_m.emplace_back(point.tcp_position.begin(), point.tcp_position.end());
    m.feed_direction_rad.push_back(point.feed_direction);
    m.radial_depth_m.push_back(point.radial_depth);
    m.milling.push_back(static_cast<std::int8_t>(point.milling));
  }
  return to_bytes(m);
}

MessageBytes encode(const CorrectionAck& ack, std::string_view reason) {
  correction_ack_t m{};
  m.utime = to_us(ack.stamp_ns);
  m.sequence = ack.sequence;
  m.accepted = ack.accepted ? 1 : 0;
  m.spindle_speed_rpm = ack.spindle_speed_rpm;
  m.feed_override = ack.feed_override;
  m.reason = reason;
  return to_bytes(m);
}

MessageBytes encode(const Correction& correction) {
  correction_t m{};
  m.utime = to_us(correction.stamp_ns);
  m.sequence = correction.sequence;
  m.valid_for_ms = correction.valid_for_ms;
  m.valid_until_utime = m.utime + correction.valid_for_ms * kUsPerMs;
  m.mode = static_cast<std::int8_t>(correction.mode);
  m.kind = static_cast<std::int8_t>(correction.kind);
  m.spindle_speed_rpm = correction.spindle_speed_rpm;
  m.spindle_speed_target_rpm = correction.spindle_speed_target_rpm;
  m.speed_variation_ratio = correction.speed_variation_ratio;
  m.speed_variation_hz = correction.speed_variation_hz;
  m.feed_override = correction.feed_override;
  m.feed_direction_rad = correction.feed_direction;
  m.chatter_frequency_hz = correction.chatter_frequency_hz;
  m.predicted_margin_before = correction.predicted_margin_before;
  m.predicted_margin_after = correction.predicted_margin_after;
  m.limited_by = correction.limited_by;
  m.confidence_percent = correction.confidence_percent;
  m.reason = text_of(correction.reason);
  return to_bytes(m);
}

MessageBytes encode(const Event& event) {
  event_t m{};
  m.utime = to_us(event.stamp_ns);
  m.event = static_cast<std::int8_t>(event.type);
  m.kind = static_cast<std::int8_t>(event.kind);
  m.frequency_hz = event.frequency_hz;
  m.indicator = event.indicator;
  m.spindle_speed_rpm = event.spindle_speed_rpm;
  m.note = text_of(event.note);
  return to_bytes(m);
}

MessageBytes encode(const Status& status) {
  status_t m{};
  m.utime = to_us(status.stamp_ns);
  m.state = static_cast<std::int8_t>(status.state);
  m.mode = static_cast<std::int8_t>(status.mode);
  m.spindle_speed_rpm = status.spindle_speed_rpm;
  m.indicator = status.indicator;
  m.margin = status.margin;
  m.chatter_frequency_hz = status.chatter_frequency_hz;
  m.frames = status.frames;
  m.frames_lost = status.frames_lost;
  m.lobes_utime = to_us(status.lobes_stamp_ns);
  return to_bytes(m);
}

Received<RobotState> decode_robot_state(std::span<const std::uint8_t> bytes, std::int64_t stamp_ns) {
  robot_state_t m{};
  if (!from_bytes(bytes, m)) return refused<RobotState>(kWrongType);
  if (const char* why_not = reason_to_refuse(m)) return refused<RobotState>(why_not);

  RobotState state;
  state.stamp_ns = stamp_ns;
  std::copy_n(m.joint_position_rad, state.joint_position.size(), state.joint_position.begin());
  std::copy_n(m.tcp_position_m, state.tcp_position.size(), state.tcp_position.begin());
  std::copy_n(m.tool_orientation_wxyz, state.tool_orientation.size(), state.tool_orientation.begin());
  double squared_length = 0.0;
  for (const double component : state.tool_orientation) squared_length += component * component;
  if (squared_length < kShortestOrientation * kShortestOrientation) {
    return refused<RobotState>("tool_orientation_wxyz has no length");
  }
  if (std::abs(squared_length - 1.0) > kUnitTolerance) {
    for (double& component : state.tool_orientation) component /= std::sqrt(squared_length);
  }
  state.feed_direction = m.feed_direction_rad;
  state.feed_rate = m.feed_rate_m_per_s;
  state.spindle_speed_rpm = m.spindle_speed_rpm;
  state.axial_depth = m.axial_depth_m;
  state.radial_depth = m.radial_depth_m;
  state.milling = static_cast<Milling>(m.milling);
  state.block = m.block;
  return {state};
}

Received<RobotPath> decode_robot_path(std::span<const std::uint8_t> bytes, std::int64_t stamp_ns) {
  robot_path_t m{};
  if (!count_fits(bytes) || !from_bytes(bytes, m)) return refused<RobotPath>(kWrongType);
  if (const char* why_not = reason_to_refuse(m)) return refused<RobotPath>(why_not);
  RobotPath path;
  path.stamp_ns = stamp_ns;
  path.count = m.after_s.size();
  for (std::size_t i = 0; i < path.count; ++i) {
    PathPoint& point = path.points[i];
    point.after = m.after_s[i];
    std::copy_n(m.joint_position_rad[i].begin(), point.joint_position.size(), point.joint_position.begin());
    std::copy_n(m.tcp_position_m[i].begin(), point.tcp_position.size(), point.tcp_position.begin());
    point.feed_direction = m.feed_direction_rad[i];
    point.radial_depth = m.radial_depth_m[i];
    point.milling = static_cast<Milling>(m.milling[i]);
  }
  return {path};
}

Received<CorrectionAck> decode_correction_ack(std::span<const std::uint8_t> bytes, std::int64_t stamp_ns) {
  correction_ack_t m{};
  if (!from_bytes(bytes, m)) return refused<CorrectionAck>(kWrongType);
  if (const char* why_not = reason_to_refuse(m)) return refused<CorrectionAck>(why_not);
  // What cannot be printed has no place in a line of a log.
  std::replace_if(
      m.reason.begin(), m.reason.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  return {
      CorrectionAck{stamp_ns, m.sequence, m.accepted == 1, m.spindle_speed_rpm, m.feed_override, short_text(m.reason)}};
}

Received<Correction> decode_correction(std::span<const std::uint8_t> bytes) {
  correction_t m{};
  if (!from_bytes(bytes, m)) return refused<Correction>(kWrongType);
  if (!is_time(m.utime)) return refused<Correction>(kBadTime);
  if (m.mode < 0 || m.mode > 2) return refused<Correction>("mode is not 0, 1 or 2");
  if (m.kind < 0 || m.kind > 5) return refused<Correction>("kind is not from 0 to 5");

  Correction correction;
  correction.stamp_ns = m.utime * kNsPerUs;
  correction.sequence = m.sequence;
  correction.valid_for_ms = m.valid_for_ms;
  correction.mode = static_cast<RuntimeMode>(m.mode);
  correction.kind = static_cast<CorrectionKind>(m.kind);
  correction.spindle_speed_rpm = m.spindle_speed_rpm;
  correction.spindle_speed_target_rpm = m.spindle_speed_target_rpm;
  correction.speed_variation_ratio = m.speed_variation_ratio;
  correction.speed_variation_hz = m.speed_variation_hz;
  correction.feed_override = m.feed_override;
  correction.feed_direction = m.feed_direction_rad;
  correction.chatter_frequency_hz = m.chatter_frequency_hz;
  correction.predicted_margin_before = m.predicted_margin_before;
  correction.predicted_margin_after = m.predicted_margin_after;
  correction.limited_by = m.limited_by;
  correction.confidence_percent = m.confidence_percent;
  correction.reason = short_text(m.reason);
  return {correction};
}

Received<Event> decode_event(std::span<const std::uint8_t> bytes) {
  event_t m{};
  if (!from_bytes(bytes, m)) return refused<Event>(kWrongType);
  if (!is_time(m.utime)) return refused<Event>(kBadTime);
  if (m.event < 1 || m.event > 7) return refused<Event>("event is not from 1 to 7");
  if (m.kind < 0 || m.kind > 2) return refused<Event>("kind is not 0, 1 or 2");
  return {Event{m.utime * kNsPerUs, static_cast<EventType>(m.event), static_cast<ChatterKind>(m.kind), m.frequency_hz,
                m.indicator, m.spindle_speed_rpm, short_text(m.note)}};
}

Received<Status> decode_status(std::span<const std::uint8_t> bytes) {
  status_t m{};
  if (!from_bytes(bytes, m)) return refused<Status>(kWrongType);
  if (!is_time(m.utime) || !is_time(m.lobes_utime)) return refused<Status>(kBadTime);
  if (m.state < 0 || m.state > 7) return refused<Status>("state is not from 0 to 7");
  if (m.mode < 0 || m.mode > 2) return refused<Status>("mode is not 0, 1 or 2");
  return {Status{m.utime * kNsPerUs, static_cast<State>(m.state), static_cast<RuntimeMode>(m.mode), m.spindle_speed_rpm,
                 m.indicator, m.margin, m.chatter_frequency_hz, m.frames, m.frames_lost, m.lobes_utime * kNsPerUs}};
}

}  // namespace stillcut
