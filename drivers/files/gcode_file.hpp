// Tool paths from G-code (RS-274), as CAM systems post it for three axes. docs/tool-paths.md lists the words.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "models/tool_path.hpp"

namespace stillcut {

// Arcs are broken into chords that lie 10 µm beside them at most. Millimetres, absolute coordinates and feed per minute
// hold until the program says otherwise. The path begins where X, Y and Z are all known. A number without a point is in
// whole units. Lines with block delete '/' are read.
//
// Throws InputError "FILE:LINE: word: what is wrong and what to do" for every word that is not known to leave the
// tool's way as written: nothing is skipped in silence.
ToolPath read_gcode(const std::filesystem::path& file);
// `file` is the name used in messages, its stem the path's.
ToolPath parse_gcode(std::string_view text, const std::string& file);

}  // namespace stillcut
