// Tool paths as plain G-code that Fanuc and LinuxCNC controls take.
#pragma once

#include <cstddef>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "models/tool_path.hpp"

namespace stillcut {

struct GcodeHeader {
  std::string name;                                           // of the path; first comment
  std::vector<std::string> remarks;                           // a comment each, below the name
  std::vector<std::pair<std::size_t, std::string>> sections;  // a comment before the move of this index, in order
};

// Positions are rounded to 0.1 µm, feeds to 0.01 mm/min, spindle speeds to whole turns a minute (controls take no point
// in S). A cutting move, or one with a feed, is G1; others are G0. The program goes to the first move's start in X and
// Y, then in Z. Moves that rounding leaves no length are left out.
//
// Throws std::invalid_argument for a path without moves, a coordinate that is no number or beyond 100 m, a gap between
// moves, a tilted tool, and a cutting move whose feed or spindle speed is not said or rounds to 0.
void write_gcode(const ToolPath& path, std::ostream& out, const GcodeHeader& header);

}  // namespace stillcut
