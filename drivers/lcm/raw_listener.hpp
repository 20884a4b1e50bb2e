// Hears channels by their names or by patterns, whoever sends and of whatever type: for `stillcut echo` and `hz`.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>

#include "drivers/lcm/connection.hpp"

namespace stillcut {

struct RawMessage {
  std::string_view channel;
  std::span<const std::uint8_t> bytes;
  std::int64_t received_us;  // unix time; over UDP the kernel's stamp of the packet
};

// "": a name of channels or a pattern that LCM can read; otherwise what is wrong with it.
std::string why_no_pattern(const std::string& pattern);

class RawListener {
 public:
  // `patterns`: names or regular expressions that match a whole name; ".*" hears all. Throws std::invalid_argument
  // where one is none. on_message is called within wait() and must not throw: LCM, which calls, is C.
  RawListener(LcmConnection connection, std::span<const std::string> patterns,
              std::function<void(const RawMessage&)> on_message);
  ~RawListener();
  RawListener(const RawListener&) = delete;
  RawListener& operator=(const RawListener&) = delete;

  // Handles what has come; where nothing has, waits for that. False: the link is broken.
  bool wait(int milliseconds);

 private:
  static void receive(const lcm_recv_buf_t* buffer, const char* channel, void* listener) noexcept;

  LcmConnection connection_;
  std::function<void(const RawMessage&)> on_message_;
  lcm_subscription_t* subscription_ = nullptr;
};

}  // namespace stillcut
