// What the adapters' command lines share, and what becomes of it together with the cell file.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>

#include "adapters/controller_session.hpp"
#include "drivers/files/cell.hpp"

namespace stillcut {

struct AdapterOptions {
  std::string cell;
  std::string lcm;     // empty: the cell's
  std::string record;  // file for the exchange; empty: none
  double min_feed_percent = 30.0, max_feed_percent = 100.0;
  double max_path_offset_mm = 0.0;
  double cycle_ms = 4.0;
  double duration_s = 0.0;  // 0: until SIGINT or SIGTERM
};

// For an option that holds an address: ADDRESS:PORT, or PORT.
std::string complain_of_address(const std::string& text);

void add_adapter_options(CLI::App& app, AdapterOptions& options);

struct AdapterSettings {
  SessionSettings session;
  std::string lcm_url;
};

// Reads the cell for its spindle, nominal cut and LCM address. Throws InputError.
AdapterSettings adapter_settings(const AdapterOptions& options, const std::array<const char*, 6>& refusals);

// Parses the command line and runs it; the exit codes are those of the other programs. Used by every main here.
int run_adapter_program(CLI::App& app, int argc, char** argv, const std::function<void()>& run);

}  // namespace stillcut
