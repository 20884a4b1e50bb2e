// Sends what the core decided to the LCM network. A call may take tens of milliseconds on a loaded machine: only an
// ordinary thread publishes, never the real-time one.
#pragma once

#include <atomic>
#include <cstdint>
#include <string_view>

#include "drivers/lcm/connection.hpp"
#include "drivers/lcm/telemetry_messages.hpp"

namespace stillcut {

class Publisher {
 public:
  explicit Publisher(LcmConnection connection) : connection_{std::move(connection)} {}

  // One thread at a time. False, and counted, when the message could not be sent.
  bool publish(const Output& output);
  bool publish(const RobotState& state);  // the plant speaks for the robot
  bool publish(const RobotPath& path);
  bool publish(const CorrectionAck& ack, std::string_view reason = {});
  bool publish(const TelemetryMessage& message);

  // Any thread.
  [[nodiscard]] std::int64_t sent() const noexcept { return sent_.load(std::memory_order_relaxed); }
  [[nodiscard]] std::int64_t failed() const noexcept { return failed_.load(std::memory_order_relaxed); }

 private:
  bool send(const char* channel, const MessageBytes& bytes);

  LcmConnection connection_;
  std::atomic<std::int64_t> sent_{0};
  std::atomic<std::int64_t> failed_{0};
};

}  // namespace stillcut
