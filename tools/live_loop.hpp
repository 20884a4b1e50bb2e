// The daemon's real-time side: what one tick of the loop does, and the wait-free channels to the ordinary threads.
//
//   from                to                  through
//   model thread        loop                lobes, ahead snapshots, newest diagram of each
//   subscriber thread   loop                messages     ring, robot states and acknowledgements
//   loop                publisher thread    outputs      ring, events, corrections, status
//   loop                recorder thread     recorded     ring, all that went into the core, in that order
//   loop                telemetry thread    watched      ring, frames that went into the core
//   loop                telemetry thread    view         snapshot, what the core knows, 200 times a second
//   model thread        telemetry thread    shown_lobes  snapshot, the newest diagram of the present posture
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <variant>

#include "drivers/can/can_bus.hpp"
#include "drivers/lcm/lcm_log.hpp"
#include "drivers/lcm/recording_messages.hpp"
#include "models/lobe_diagram.hpp"
#include "rt/loop_times.hpp"
#include "rt/ring.hpp"
#include "rt/snapshot.hpp"
#include "rt/timekeeper.hpp"
#include "tools/loop_view.hpp"
#include "tools/pipeline.hpp"

namespace stillcut {

std::int64_t realtime_ns() noexcept;  // this host's CLOCK_REALTIME

// What goes into the core, as the recorder gets it. Of a diagram only that it was taken up.
using CoreInput = std::variant<CanFrame, RobotState, CorrectionAck, LobesUsed, Silence, LoopTiming>;

// A diagram and the number of the question that it answers (tools/recorder.hpp); 0: nobody records.
struct LobesAnswer {
  LobeDiagram diagram;
  std::int64_t question = 0;
};

struct LoopChannels {
  // Whether somebody takes what goes into the core, and the frames of it; their rings are most of the memory here.
  explicit LoopChannels(bool recorded_too = true, bool watched_too = true)
      : recorded{recorded_too ? std::size_t{32768} : std::size_t{1}},
        watched{watched_too ? std::size_t{1024} : std::size_t{1}} {}

  Snapshot<LobesAnswer> lobes, ahead;  // of the present posture, along the announced path
  Ring<RobotMessage> messages{256};
  Ring<Output> outputs{4096};
  Ring<CoreInput> recorded;  // ten seconds of a triaxial 25.6 kHz sensor
  Ring<CanFrame> watched;    // 0.4 s of it; small, so that it stays in the cache
  Snapshot<LoopView> view;
  Snapshot<LobeDiagram> shown_lobes;
  std::atomic<std::int64_t> origin_ns{0};  // stamp of the first frame, time zero of events; set before the first output
  LoopTimes times;
};

class LiveLoop {
 public:
  using Clock = std::int64_t (*)() noexcept;

  // live_clock: the bus stamps with this host's CLOCK_REALTIME, so silence can be told from it; false for a log.
  // record: hand all that goes into the core to the recorder's ring. must_keep_time: out of time, what was asked for is
  // released. watched: hand frames and view to the telemetry. All references must outlive the loop.
  LiveLoop(CanBus& bus, Pipeline& pipeline, LoopChannels& channels, bool live_clock, bool record, bool must_keep_time,
           Clock clock = realtime_ns, bool watched = false) noexcept
      : bus_{bus},
        pipeline_{pipeline},
        channels_{channels},
        live_clock_{live_clock},
        record_{record},
        must_keep_time_{must_keep_time},
        watched_{watched},
        clock_{clock} {
    pipeline_.set_probe(channels_.times.stages.probe());
  }

  // One tick on the real-time thread, awake at a time of CLOCK_MONOTONIC; false when the bus has come to its end (a
  // log). No allocation, no lock, no system call but receive and clock.
  bool tick(std::int64_t awake_ns) noexcept;

 private:
  void keep_time(std::int64_t awake_ns) noexcept;
  void drain_bus() noexcept;
  void place_in_time(CanFrame& frame) noexcept;
  void place_in_time(RobotMessage& message) const noexcept;
  void take_lobes(const LobesAnswer& answer) noexcept;
  void feed_messages_until(std::int64_t stamp_ns) noexcept;
  void feed(const CanFrame& frame) noexcept;
  void feed_silence() noexcept;
  void record(const CoreInput& input) noexcept;
  bool hand_over() noexcept;  // true: there was something
  void show() noexcept;

  CanBus& bus_;
  Pipeline& pipeline_;
  LoopChannels& channels_;
  bool live_clock_, record_, must_keep_time_, watched_;
  bool drained_ = false;  // the bus, in this tick
  Timekeeper timekeeper_{kLoopPeriodNs};
  Clock clock_;
  std::array<CanFrame, 64> batch_{};
  LoopTiming timing_;
  bool has_timing_ = false;  // the core has yet to be told
  RobotMessage waiting_{};
  bool has_waiting_ = false;
  bool frame_fed_ = false;
  bool handed_over_ = false;         // in this tick
  int ticks_to_show_ = 0;            // until the view is due again
  std::int64_t fed_ns_ = 0;          // the core's data time: newest frame, or declared silence
  std::int64_t declared_ns_ = 0;     // up to here data time has been moved on in silence
  std::int64_t clock_shift_ns_ = 0;  // added to the clock and the stamps after the host's clock was set back
};

}  // namespace stillcut
