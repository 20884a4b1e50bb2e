// stillcutd: the live monitor and compensator of one cell, until a signal ends it.
#pragma once

#include <string>

namespace stillcut {

struct DaemonOptions {
  std::string cell;
  std::string record;                // FILE.log or a recording's folder (live_run.hpp)
  std::string events;                // file for the events as CSV; empty: none
  double duration_s = 0;             // end after this long; 0: on SIGTERM or SIGINT
  int priority = 80;                 // SCHED_FIFO
  int cpu = -1;                      // processor of the loop; -1: any
  bool json = false;                 // the summary as one JSON object on standard output
  bool allow_not_real_time = false;  // active on a host that cannot keep time: for the bench
  bool telemetry = true;             // tell onlookers what is heard and thought
  bool audit = false;                // end with status 134 at the loop's first forbidden system call
};

// Runs to its end. Throws InputError and ComponentError before it starts; after that inputs cannot end it.
void run_daemon(const DaemonOptions& options);

}  // namespace stillcut
