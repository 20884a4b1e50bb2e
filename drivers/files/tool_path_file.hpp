// A tool path from a file of either kind: G-code or APT cutter locations.
#pragma once

#include <filesystem>

#include "models/tool_path.hpp"

namespace stillcut {

// The name's ending chooses: .nc .ngc .gcode .tap .cnc are G-code, .cl .cls .apt .aptsource cutter locations; any other
// the first words of the file. Throws InputError as the two readers do, and where the file is neither.
ToolPath read_tool_path(const std::filesystem::path& file);

}  // namespace stillcut
