// Hears what the monitor publishes: corrections and events, decoded and checked. For the simulated machine, which obeys
// the ones and keeps its score by the others.
#pragma once

#include <functional>
#include <optional>
#include <thread>
#include <vector>

#include "drivers/lcm/connection.hpp"
#include "rt/signals.hpp"

namespace stillcut {

class MonitorListener {
 public:
  // Called on the thread that handles the connection; may be empty; none may throw: LCM, which calls, is C.
  struct Handlers {
    std::function<void(const Correction&)> on_correction;
    std::function<void(const Event&)> on_event;
  };
  enum class Thread { own, none };  // none: a Subscriber on the same connection handles it

  MonitorListener(LcmConnection connection, Handlers handlers, Thread thread);
  ~MonitorListener();  // returns within 0.1 s
  MonitorListener(const MonitorListener&) = delete;
  MonitorListener& operator=(const MonitorListener&) = delete;

 private:
  static void receive_correction(const lcm_recv_buf_t* buffer, const char* channel, void* listener) noexcept;
  static void receive_event(const lcm_recv_buf_t* buffer, const char* channel, void* listener) noexcept;

  LcmConnection connection_;
  Handlers handlers_;
  std::vector<lcm_subscription_t*> subscriptions_;
  std::optional<std::jthread> thread_;
};

}  // namespace stillcut
