// What the daemon tells the service manager that started it (systemd, Type=notify): ready, its state in one line, that
// the loop still ticks, that it ends. Without a manager every call does nothing. For the thread that waits for the end;
// the loop itself is only looked at.
#pragma once

#include <cstdint>
#include <string>

#include "rt/signals.hpp"

namespace stillcut {

// "chatter, active, 8500 rpm, 1234 frames, 0 lost": for `systemctl status`.
std::string service_status_line(const Status& status);

class ServiceNotify {
 public:
  ServiceNotify();  // asks the environment for a manager and its watchdog

  // Once in a while, ten times within the watchdog's time at least: `ticks` of the loop since its start, and what it
  // said last. Ready is told at the first tick. The watchdog is fed where ticks were added since it was last fed and
  // never by time alone: a loop that hangs is not alive, however well this thread is.
  void progress(std::uint64_t ticks, const Status& status, std::int64_t now_ns);

  void stopping();

 private:
  bool ready_ = false;
  std::int64_t feed_every_ns_ = 0;  // 0: no watchdog
  std::int64_t fed_ns_ = 0, told_ns_ = 0;
  std::uint64_t fed_ticks_ = 0;
  std::string told_;
};

}  // namespace stillcut
