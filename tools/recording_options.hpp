// The options of commands that play a recording.
#pragma once

#include <CLI/CLI.hpp>

#include "tools/playback.hpp"

namespace stillcut {

// --can, which must be given, --lcm and --lcm-offset. `source` must live as long as the command.
void add_recording_options(CLI::App& command, PlaybackSource& source);

}  // namespace stillcut
