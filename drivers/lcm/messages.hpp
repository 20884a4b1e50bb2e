// The LCM messages (the .lcm files of this folder) as the core's plain values: encoding to bytes, decoding from bytes,
// and the check of what comes in. The classes that lcm-gen makes stay inside messages.cpp.
//
// Times: a message carries microseconds, the core nanoseconds. A robot's utime is the controller's own clock, which
// nobody here can place; a decoded robot message is therefore stamped by the caller with the time it was received.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <string_view>
#include <vector>

#include "rt/signals.hpp"

namespace stillcut {

inline constexpr const char *kRobotStateChannel = "ROBOT_STATE", *kRobotAckChannel = "ROBOT_ACK",
                            *kRobotPathChannel = "ROBOT_PATH", *kCorrectionChannel = "STILLCUT_CORRECTION",
                            *kEventChannel = "STILLCUT_EVENT", *kStatusChannel = "STILLCUT_STATUS";

// The last microsecond, counted from 1970, that fits in nanoseconds.
inline constexpr std::int64_t kLastUs = std::numeric_limits<std::int64_t>::max() / 1000;

using MessageBytes = std::vector<std::uint8_t>;

MessageBytes encode(const RobotState& state);
MessageBytes encode(const RobotPath& path);
MessageBytes encode(const CorrectionAck& ack, std::string_view reason = {});
MessageBytes encode(const Correction& correction);
MessageBytes encode(const Event& event);
MessageBytes encode(const Status& status);

// A decoded message, or why it cannot be trusted ("feed_rate_m_per_s is not a number from 0 to 100").
template <class T>
struct Received {
  T value{};
  const char* why_not = nullptr;  // nullptr: value is good

  [[nodiscard]] bool ok() const noexcept { return why_not == nullptr; }
};

// From the robot. Refused: bytes of another type or length, numbers that are not finite or beyond any machine, a tool
// orientation of no length, a milling kind out of range. Depths may be NaN: unknown. The orientation is normalised.
Received<RobotState> decode_robot_state(std::span<const std::uint8_t> bytes, std::int64_t stamp_ns);
Received<RobotPath> decode_robot_path(std::span<const std::uint8_t> bytes, std::int64_t stamp_ns);
Received<CorrectionAck> decode_correction_ack(std::span<const std::uint8_t> bytes, std::int64_t stamp_ns);

// What the daemon publishes, for the plant and the tests; the stamp is the message's utime. Texts longer than a
// ShortText are cut.
Received<Correction> decode_correction(std::span<const std::uint8_t> bytes);
Received<Event> decode_event(std::span<const std::uint8_t> bytes);
Received<Status> decode_status(std::span<const std::uint8_t> bytes);

}  // namespace stillcut
