// Runs the LinuxCNC adapter: connection, threads, signals and log around linuxcnc_adapter.
#pragma once

#include "adapters/adapter_options.hpp"
#include "adapters/linuxcnc_adapter.hpp"

namespace stillcut {

struct LinuxCncOptions {
  AdapterOptions adapter;
  std::string server = "127.0.0.1:5007";
  LinuxCncLogin login;
};

// Until a signal or the end of the duration; connects again whenever the connection breaks. Throws InputError and
// ComponentError before it connects first.
void run_linuxcnc_adapter(const LinuxCncOptions& options);

}  // namespace stillcut
