// The dynamics map on disk: a folder with postures.csv (where the machine stood) and modes.csv (how it shook there), as
// contracts.md describes them.
#pragma once

#include <filesystem>
#include <ostream>
#include <string_view>

#include "models/dynamics_map.hpp"

namespace stillcut {

// Reads and checks both files. Throws InputError, with file, line and column, for: no posture; an id or a place that
// stands twice; some but not all joint columns; a posture without modes or modes without a posture; a frequency,
// damping ratio (between 0 and 1) or stiffness that no structure has; a direction whose length is off 1 by more than 5
// % (a smaller rounding error is mended). Modes come in rising frequency.
DynamicsMap read_dynamics_map(const std::filesystem::path& folder);

// The same for text at hand; `folder` is the one named in messages.
DynamicsMap parse_dynamics_map(std::string_view postures_text, std::string_view modes_text,
                               const std::filesystem::path& folder);

// Writes both files; makes the folder. Numbers are written so that they read back equal, but for the last bit where a
// unit is converted. Throws InputError when a file cannot be written.
void write_dynamics_map(const std::filesystem::path& folder, const DynamicsMap& map);

// Each of the two alone.
void write_postures(std::ostream& out, const DynamicsMap& map);
void write_modes(std::ostream& out, const DynamicsMap& map);

}  // namespace stillcut
