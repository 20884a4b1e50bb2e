// Monitor and machine in closed loop, in data time: the daemon's own pipeline hears the simulated machine's frames and
// messages in the order of their stamps, and the machine gets what it publishes. No clock, no thread: a run repeats to
// the bit and takes a fraction of the time it tells of.
#pragma once

#include <functional>
#include <vector>

#include "drivers/files/cell.hpp"
#include "rt/signals.hpp"
#include "tools/pipeline.hpp"
#include "tools/plot_replay.hpp"
#include "tools/virtual_machine.hpp"

namespace stillcut {

// What the monitor said in a run; stamps are on the machine's clock.
struct Heard {
  std::vector<Event> events;
  std::vector<Correction> corrections;  // every message, in data time
  std::vector<TracePoint> trace;        // time_s since the machine's start

  void add(const Output& output, std::int64_t origin_ns);
};

// Whom to tell of a run besides; what is empty is not told.
struct DataTimeListener {
  std::function<void(const Pipeline&)> on_frame;              // a frame brought samples or speed: see decoded()
  std::function<void(const Output&, const Core&)> on_output;  // what was decided, in order
};

// Runs the machine to its end. cell.mode says what becomes of corrections. `progress` is told the share that is done.
Heard run_in_data_time(const Cell& cell, VirtualMachine& machine, const std::function<void(double)>& progress = {},
                       const DataTimeListener& listener = {});

}  // namespace stillcut
