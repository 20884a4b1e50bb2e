// The simulated machine in real time: its sensors and drive on a CAN bus, its controller on LCM, the code of
// tools/virtual_machine paced by the clock.
#pragma once

#include <mutex>
#include <span>
#include <vector>

#include "drivers/can/can_bus.hpp"
#include "drivers/lcm/connection.hpp"
#include "tools/closed_loop.hpp"
#include "tools/virtual_machine.hpp"

namespace stillcut {

// What the monitor says, from the thread that hears it to the one that runs the machine.
class MonitorInbox {
 public:
  void add(const Output& output);
  std::vector<Correction> take_corrections();
  Heard take_heard(std::int64_t origin_ns);  // at the end: everything else

 private:
  std::mutex mutex_;
  std::vector<Correction> corrections_;
  std::vector<Output> others_;
};

struct PlantReport {
  std::int64_t unsent = 0;  // frames that the bus did not take
  double behind_ms = 0.0;   // the most that the machine was behind the clock
};

// Runs the machine from its origin on (CLOCK_REALTIME) to its end. Sends on the calling thread, which asks for a
// real-time priority below the monitor's and goes on without. `progress` is told the share that is done.
PlantReport run_in_real_time(VirtualMachine& machine, CanBus& bus, const LcmConnection& lcm, MonitorInbox& inbox,
                             const std::function<void(double)>& progress = {});

}  // namespace stillcut
