// The monitor live on one cell: the real-time loop and the ordinary threads about it (publisher, recorder, model,
// subscriber), from construction until stop(). The daemon runs one; `stillcut hil` runs one beside a simulated machine.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "drivers/files/cell.hpp"
#include "drivers/lcm/connection.hpp"
#include "rt/signals.hpp"

namespace stillcut {

struct LiveRunOptions {
  // FILE.log: a plain candump log of the frames that went into the core; else a recording's folder, in the place of the
  // cell's own; empty: as the cell says.
  std::string record;
  bool cell_records = true;  // where the cell names a folder; false: only what `record` asks for
  std::string events;        // file for the events as CSV; empty: none
  int priority = 80;         // SCHED_FIFO
  int cpu = -1;              // processor of the loop; -1: any
  bool audit = false;        // end with status 134 at the loop's first forbidden system call
  // Active on a host that cannot keep time, and no release when the loop falls out of time: for the bench.
  bool allow_not_real_time = false;
  bool telemetry = true;  // tell onlookers over LCM what is heard and thought (tools/telemetry.hpp)
  std::function<void(const Output&)>
      on_output;  // told of all that is published, on the publisher's thread; may be empty
};

struct TickTimes {
  double p50_us = 0.0, p9999_us = 0.0, max_us = 0.0;
};

class LiveRun {
 public:
  // Starts; `bus` is the cell's or another. Throws InputError and ComponentError.
  LiveRun(const Cell& cell, const std::string& bus, const LcmConnection& lcm, const LiveRunOptions& options);
  ~LiveRun();  // stops
  LiveRun(const LiveRun&) = delete;
  LiveRun& operator=(const LiveRun&) = delete;

  // The bus has come to its end (a log).
  [[nodiscard]] bool ended() const;

  // Of the loop since its start: they go on as long as it lives.
  [[nodiscard]] std::uint64_t ticks() const;

  // Keeps the seconds about now in the recording; nothing where none is made.
  void mark(const std::string& why);

  // Ends the loop, publishes what is left and the release that every end owes the controller.
  void stop();

  // After stop().
  [[nodiscard]] nlohmann::ordered_json summary() const;
  [[nodiscard]] TickTimes tick_times() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace stillcut
