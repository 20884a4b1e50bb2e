// The daemon's real-time side: what one tick of the loop does, and the wait-free channels to the ordinary threads.
//
//   from                to                  through
//   model thread        loop                lobes, ahead snapshots, newest diagram of each
//   subscriber thread   loop                messages     ring, robot states and acknowledgements
//   loop                publisher thread    outputs      ring, events, corrections, status
//   loop                recorder thread     recorded     ring, every frame that went into the core
#pragma once

#include <array>
#include <atomic>
#include <cstdint>

#include "drivers/can/can_bus.hpp"
#include "drivers/lcm/lcm_log.hpp"
#include "models/lobe_diagram.hpp"
#include "rt/loop_times.hpp"
#include "rt/ring.hpp"
#include "rt/snapshot.hpp"
#include "rt/timekeeper.hpp"
#include "tools/pipeline.hpp"

namespace stillcut {

std::int64_t realtime_ns() noexcept;  // this host's CLOCK_REALTIME

struct LoopChannels {
  Snapshot<LobeDiagram> lobes, ahead;  // of the present posture, along the announced path
  Ring<RobotMessage> messages{256};
  Ring<Output> outputs{4096};
  Ring<CanFrame> recorded{32768};          // ten seconds of a triaxial 25.6 kHz sensor
  std::atomic<std::int64_t> origin_ns{0};  // stamp of the first frame, time zero of events; set before the first output
  LoopTimes times;
};

class LiveLoop {
 public:
  // live_clock: the bus stamps with this host's CLOCK_REALTIME, so silence can be told from it; false for a log.
  // record: hand every frame to the recorder's ring. must_keep_time: out of time, what was asked for is released.
  // All references must outlive the loop.
  LiveLoop(CanBus& bus, Pipeline& pipeline, LoopChannels& channels, bool live_clock, bool record,
           bool must_keep_time) noexcept
      : bus_{bus},
        pipeline_{pipeline},
        channels_{channels},
        live_clock_{live_clock},
        record_{record},
        must_keep_time_{must_keep_time} {
    pipeline_.set_probe(channels_.times.stages.probe());
  }

  // One tick on the real-time thread, awake at a time of CLOCK_MONOTONIC; false when the bus has come to its end (a
  // log). No allocation, no lock, no system call but receive and clock.
  bool tick(std::int64_t awake_ns) noexcept;

 private:
  void keep_time(std::int64_t awake_ns) noexcept;
  void drain_bus() noexcept;
  void place_in_time(CanFrame& frame) noexcept;
  void feed_messages_until(std::int64_t stamp_ns) noexcept;
  bool hand_over() noexcept;  // true: there was something

  CanBus& bus_;
  Pipeline& pipeline_;
  LoopChannels& channels_;
  bool live_clock_, record_, must_keep_time_;
  bool drained_ = false;  // the bus, in this tick
  Timekeeper timekeeper_{kLoopPeriodNs};
  std::array<CanFrame, 64> batch_{};
  RobotMessage waiting_{};
  bool has_waiting_ = false;
  std::int64_t declared_ns_ = 0;     // up to here data time has been moved on in silence
  std::int64_t clock_shift_ns_ = 0;  // added to the clock and the stamps after the host's clock was set back
};

}  // namespace stillcut
