// Corrections of a dynamics map that somebody has yet to accept: proposals.csv beside its modes.csv. Nothing reads them
// but `stillcut refine`.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "models/dynamics_map.hpp"

namespace stillcut {

enum class ProposalStatus { open, accepted, rejected };

// Of one mode's natural frequency.
struct MapProposal {
  std::string posture;
  int mode = 0;                        // in rising frequency, from 1
  double frequency_hz = 0.0;           // in the map
  double proposed_frequency_hz = 0.0;  // instead
  double frequency_hz_se = 0.0;        // standard error of the latter
  int observations = 0;
  ProposalStatus status = ProposalStatus::open;
  std::string evidence;  // for the reader

  [[nodiscard]] std::string id() const { return posture + "/" + std::to_string(mode); }
};

// Empty where the folder has none. Throws InputError with file and line for a column that is missing, a number out of
// range, an unknown status, a mode that stands twice.
std::vector<MapProposal> read_map_proposals(const std::filesystem::path& folder);
// Frequencies to the millionth of a Hz.
void write_map_proposals(const std::filesystem::path& folder, const std::vector<MapProposal>& proposals);

// The map with these proposals. Throws InputError where a posture or mode is not in the map, or is not as it was when
// the proposal was made.
DynamicsMap with_proposals(DynamicsMap map, const std::vector<MapProposal>& proposals,
                           const std::filesystem::path& folder);

// Writes modes.csv anew, in one step: whoever reads meets the old or the new. The old is kept as modes.csv.1, .2, …,
// whose name is given back. Throws InputError.
std::filesystem::path replace_modes(const std::filesystem::path& folder, const DynamicsMap& map);

}  // namespace stillcut
