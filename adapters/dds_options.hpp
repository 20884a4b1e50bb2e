// The command line of stillcut-dds.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "drivers/dds/dds_settings.hpp"

namespace stillcut {

struct DdsOptions {
  std::string cell;  // empty: listens
  std::string lcm;   // empty: the cell's
  std::string name = "stillcut";
  DdsSettings dds;
  bool listen = false;
  double duration_s = 0.0;  // 0: until SIGINT or SIGTERM
};

void add_dds_options(CLI::App& app, DdsOptions& options);

// Each says in one line what is wrong with the text, or nothing.
std::string complain_of_domain(const std::string& text);
std::string complain_of_namespace(const std::string& text);  // as ROS 2 names are: cell_2, hall/left
std::string complain_of_partition(const std::string& text);
std::string complain_of_servers(const std::string& text);  // HOST, HOST:PORT, several with ';' between

}  // namespace stillcut
