// The dynamics map on disk: a folder with postures.csv (where the machine stood) and modes.csv (how it shook there), as
// contracts.md describes them.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

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

// postures.csv alone: where the machine stood, no modes yet. Throws InputError as read_dynamics_map.
DynamicsMap read_postures(const std::filesystem::path& file);

struct MapNames {
  std::vector<std::vector<int>> mode_numbers{};  // [posture][mode]: what `mode` says; empty: 1, 2, … at each posture
  bool places_known = true;                      // false: the places are left empty, for the user to fill in
};

// Both files as text, in the order postures.csv, modes.csv. Numbers are written so that they read back equal, but for
// the last bit where a unit is converted.
std::array<std::string, 2> dynamics_map_text(const DynamicsMap& map, const MapNames& names = {});

// Writes both files, or none (write_text_files). Throws InputError when a file cannot be written.
void write_dynamics_map(const std::filesystem::path& folder, const DynamicsMap& map);

}  // namespace stillcut
