// Hears all that the daemon tells, for those who look on: the page, the terminal, the bridge to DDS. Each is a process
// of its own; none can hold the daemon up.
#pragma once

#include <atomic>
#include <functional>
#include <string_view>
#include <thread>
#include <vector>

#include "drivers/lcm/connection.hpp"
#include "drivers/lcm/telemetry_messages.hpp"

namespace stillcut {

class TelemetryListener {
 public:
  // Called on the listener's thread; may be empty; none may throw: LCM, which calls, is C.
  struct Handlers {
    std::function<void(const TelemetryMessage&)> on_message;
    std::function<void(std::string_view channel, const char* why_not)> on_bad;
  };

  // Subscribes and starts its thread.
  TelemetryListener(LcmConnection connection, Handlers handlers);
  ~TelemetryListener();  // returns within 0.1 s and the time of a handler
  TelemetryListener(const TelemetryListener&) = delete;
  TelemetryListener& operator=(const TelemetryListener&) = delete;

  // Messages that a handler is done with. Any thread, which then sees what those handlers did.
  [[nodiscard]] std::int64_t received() const noexcept { return received_.load(std::memory_order_acquire); }
  [[nodiscard]] std::int64_t bad() const noexcept { return bad_.load(std::memory_order_acquire); }

 private:
  static void receive(const lcm_recv_buf_t* buffer, const char* channel, void* listener) noexcept;

  LcmConnection connection_;
  Handlers handlers_;
  std::vector<lcm_subscription_t*> subscriptions_;
  std::atomic<std::int64_t> received_{0}, bad_{0};
  std::jthread thread_;  // last: it starts when all else is there
};

}  // namespace stillcut
