// Tells onlookers, over LCM and on an ordinary thread, what the loop hears and thinks (tools/telemetry.hpp). It takes
// what the loop leaves in its channels; if it falls behind, what it misses is counted and the loop goes on. A part of a
// live run.
#pragma once

#include <functional>
#include <thread>

#include "drivers/can/can_bus.hpp"
#include "drivers/lcm/publisher.hpp"
#include "tools/live_loop.hpp"
#include "tools/telemetry.hpp"

namespace stillcut {

// Losses that only the live run knows.
struct LiveLosses {
  BusState bus_state = BusState::up;
  BusCounters bus;
  std::int64_t outputs_dropped = 0, record_dropped = 0, telemetry_dropped = 0, messages_bad = 0, publish_failed = 0;
};

class TelemetryThread {
 public:
  // `losses` is called on the thread, once a second. All references must outlive it.
  TelemetryThread(const Cell& cell, const Decoder& decoder, LoopChannels& channels, const LcmConnection& lcm,
                  std::function<LiveLosses()> losses);
  ~TelemetryThread() = default;
  TelemetryThread(const TelemetryThread&) = delete;
  TelemetryThread& operator=(const TelemetryThread&) = delete;

 private:
  void run(const std::stop_token& stop);
  void drain();
  void tell_health();

  LoopChannels& channels_;
  Decoder decoder_;  // its own, as it was before the first frame
  Decoded decoded_;
  Publisher publisher_;
  Telemetry telemetry_;
  std::function<LiveLosses()> losses_;
  std::int64_t health_told_ns_ = 0;
  std::jthread thread_;  // last: it starts when all else is there, and ends first
};

}  // namespace stillcut
