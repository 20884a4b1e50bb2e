// Receives the robot's messages on a thread of its own: ROBOT_STATE, ROBOT_ACK and ROBOT_PATH, decoded, checked and
// stamped with the time they came. What cannot be trusted is counted and reported, not passed on.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <string_view>
#include <thread>
#include <vector>

#include "drivers/lcm/connection.hpp"
#include "drivers/lcm/messages.hpp"

namespace stillcut {

// Called on the subscriber's thread; each may be empty; none may throw: LCM, which calls, is C.
struct RobotHandlers {
  std::function<void(const RobotState&)> on_state;
  std::function<void(const CorrectionAck&)> on_ack;
  std::function<void(const RobotPath&)> on_path;
  std::function<void(std::string_view channel, const char* why_not)> on_bad;
};

class Subscriber {
 public:
  // Nanoseconds on the CAN stamps' clock (CLOCK_REALTIME on a live machine).
  using Clock = std::function<std::int64_t()>;

  // Subscribes and starts the thread; messages published from now on arrive. Stamps are rounded down to the whole
  // microsecond that a log can hold, so that live run and playback see the same.
  Subscriber(LcmConnection connection, Clock clock, RobotHandlers handlers);

  // Stops the thread; returns within 0.1 s and the time of a handler.
  ~Subscriber();
  Subscriber(const Subscriber&) = delete;
  Subscriber& operator=(const Subscriber&) = delete;

  // Any thread.
  [[nodiscard]] std::int64_t received() const noexcept { return received_.load(std::memory_order_relaxed); }
  [[nodiscard]] std::int64_t bad() const noexcept { return bad_.load(std::memory_order_relaxed); }
  [[nodiscard]] std::int64_t link_errors() const noexcept { return link_errors_.load(std::memory_order_relaxed); }

 private:
  void run(const std::stop_token& stop);
  static void receive_state(const lcm_recv_buf_t* buffer, const char* channel, void* subscriber) noexcept;
  static void receive_ack(const lcm_recv_buf_t* buffer, const char* channel, void* subscriber) noexcept;
  static void receive_path(const lcm_recv_buf_t* buffer, const char* channel, void* subscriber) noexcept;
  template <class T>
  void hand_over(const char* channel, const Received<T>& message, const std::function<void(const T&)>& handler);
  [[nodiscard]] std::int64_t stamp() const;

  LcmConnection connection_;
  std::vector<lcm_subscription_t*> subscriptions_;
  Clock clock_;
  RobotHandlers handlers_;
  std::atomic<std::int64_t> received_{0};
  std::atomic<std::int64_t> bad_{0};
  std::atomic<std::int64_t> link_errors_{0};
  std::jthread thread_;  // last: it starts when all else is there
};

}  // namespace stillcut
