#include "tools/service_notify.hpp"

#include <systemd/sd-daemon.h>

#include <array>
#include <cstddef>
#include <cstdio>

#include "tools/spoken.hpp"

namespace stillcut {
namespace {

constexpr std::int64_t kTellEvery_ns = 1'000'000'000;  // the line is for people

}  // namespace

std::string service_status_line(const Status& status) {
  std::array<char, 160> line{};
  const int length = std::snprintf(line.data(), line.size(), "%s, %s, %.0f rpm, %lld frames, %lld lost",
                                   state_name(status.state), mode_name(status.mode), status.spindle_speed_rpm,
                                   static_cast<long long>(status.frames), static_cast<long long>(status.frames_lost));
  return {line.data(), static_cast<std::size_t>(length)};
}

ServiceNotify::ServiceNotify() {
  std::uint64_t watchdog_us = 0;
  // A quarter of its time, so that one late round does no harm.
  if (sd_watchdog_enabled(0, &watchdog_us) > 0) feed_every_ns_ = static_cast<std::int64_t>(watchdog_us) * 1000 / 4;
}

void ServiceNotify::progress(std::uint64_t ticks, const Status& status, std::int64_t now_ns) {
  if (!ready_) {
    if (ticks == 0) return;
    ready_ = true;
    sd_notify(0, "READY=1");
  }
  if (feed_every_ns_ > 0 && ticks != fed_ticks_ && now_ns - fed_ns_ >= feed_every_ns_) {
    sd_notify(0, "WATCHDOG=1");
    fed_ns_ = now_ns;
    fed_ticks_ = ticks;
  }
  if (now_ns - told_ns_ < kTellEvery_ns) return;
  told_ns_ = now_ns;
  if (const std::string line = service_status_line(status); line != told_) {
    sd_notifyf(0, "STATUS=%s", line.c_str());
    told_ = line;
  }
}

void ServiceNotify::stopping() { sd_notify(0, "STOPPING=1"); }

}  // namespace stillcut
