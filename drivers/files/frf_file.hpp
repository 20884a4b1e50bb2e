// Measured frequency responses of one posture in a file: universal files of modal analysis, or CSV.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "drivers/files/uff58_file.hpp"
#include "models/frequency_response.hpp"

namespace stillcut {

struct FrfFile {
  FrequencyResponse response;
  std::vector<std::string> notes;  // what was assumed or left out, for the user
};

// By the name's ending: .uff or .unv, .csv. Throws InputError.
[[nodiscard]] FrfFile read_frf(const std::filesystem::path& file);

// The frequency responses among the functions, as receptance in m/N: displacement, velocity or acceleration over force,
// units by dataset 164 or by the axis' own label, otherwise SI, which a note says. Functions of other types are left
// out, with a note; 0 Hz is where anything but receptance was measured. Throws InputError with file and line of the
// function for no frequency response at all, real numbers, rotations, directions that are open, response and force
// swapped, unknown quantities or units, units told twice and differently, frequencies that do not rise or differ
// between functions, functions of different nodes, an entry measured twice, a coherence beyond 0 to 1. Coherence (type
// 6) of an entry is taken where it stands on the same frequencies; a line of text "added decay NUMBER 1/s" tells of an
// exponential window, and must be of all functions alike.
[[nodiscard]] FrfFile frf_of(const UffFile& content, const std::string& file);

// Receptance in SI, node 1, double precision; coherence and added decay where they are known.
[[nodiscard]] UffFile uff_of(const FrequencyResponse& response);

}  // namespace stillcut
