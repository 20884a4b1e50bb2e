// Modes of several postures become tracks: the same physical mode bears the same number wherever it was found. Modes
// that cross in frequency are followed, and one that was missed at a posture is missing there, not replaced by another.
#pragma once

#include <span>
#include <vector>

#include "models/posture.hpp"

namespace stillcut {

// Modal assurance criterion of two modes at the tool point: the squared cosine between their directions, 0 to 1.
double modal_assurance(const Mode& a, const Mode& b);

struct TrackingSettings {
  bool places_known = true;  // false: postures count as near where their modes are alike
  JointScale scale = kEqualJoints;
  double most_difference = 0.9;  // beyond it two modes are not the same: octaves + 1 - MAC
};

struct ModeTracks {
  int count = 0;
  std::vector<std::vector<int>> number;  // [posture][mode]: its track, from 1, in rising mean log frequency

  // How many postures have the track.
  [[nodiscard]] int found(int track) const;
};

// First along the shortest tree through the postures, each compared with its nearest neighbour. Then, until nothing
// changes, every posture is compared with what the tracks' other postures predict for it: frequency by a plane through
// them (models/posture_trend), direction by its weighted mean. Within a posture the pairs with the smallest sum of
// differences are taken, a mode without a partner counting half of the most; what finds none begins a track.
// Deterministic. Throws std::invalid_argument, naming the posture, for a mode that is not physical.
ModeTracks track_modes(const DynamicsMap& map, const TrackingSettings& settings = {});

}  // namespace stillcut
