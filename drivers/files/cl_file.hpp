// Tool paths from APT cutter locations, as CAM systems write them before posting (NX .cls, .apt, .cl). They carry the
// tool's axis, which curved surfaces need. docs/tool-paths.md lists the words.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "models/tool_path.hpp"

namespace stillcut {

// Millimetres and feed per minute hold until the file says otherwise. The tool's axis holds until the next GOTO that
// names one; a move has the axis of its end. RAPID belongs to the next motion alone. The first GOTO of the file and of
// each TOOL PATH is where it begins, reached without cutting.
//
// Throws InputError "FILE:LINE: WORD: what is wrong and what to do" for every word that is not known to leave the
// tool's way as written: nothing is skipped in silence.
ToolPath read_cutter_locations(const std::filesystem::path& file);
// `file` is the name used in messages, its stem the path's.
ToolPath parse_cutter_locations(std::string_view text, const std::string& file);

}  // namespace stillcut
