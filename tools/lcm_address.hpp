// Where the commands that listen to LCM find it: "udpm://..." as it is, or the cell file that names it.
#pragma once

#include <string>

#include "drivers/files/cell.hpp"

namespace stillcut {

// "": LCM's usual address. Throws InputError for a cell file that cannot be read.
inline std::string lcm_address(const std::string& url_or_cell) {
  if (url_or_cell.empty()) return Cell{}.lcm_url;
  if (url_or_cell.find("://") != std::string::npos) return url_or_cell;
  return read_cell(url_or_cell, {.map = false, .dbc = false, .bus = false}).lcm_url;
}

// A log that lcm-logger or the recorder wrote, played by LCM itself: "file://cut.lcm?speed=0". It ends.
inline bool is_lcm_log(const std::string& url) { return url.starts_with("file:"); }

}  // namespace stillcut
