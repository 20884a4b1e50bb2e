// Modes between measured postures, by inverse distance weighting (surface paper, eqs 16-18). Two ways: `frf` weights
// the frequency responses themselves, as the paper does, which superposes the modes of all postures; `modal` weights
// matched modal parameters and keeps the number of modes.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "models/posture.hpp"

namespace stillcut {

struct Interpolation {
  bool modal = true;  // false: frf
  double power = 1.0;
  JointScale joint_scale = kEqualJoints;
};

struct PredictedPosture {
  Posture posture;                // as asked, with the predicted modes in rising frequency
  std::string nearest;            // id of the nearest measured posture
  double nearest_distance = 0.0;  // rad or m
  double map_spacing = 0.0;       // the largest distance from a measured posture to its nearest neighbour; 0: only one
  bool outside = false;           // farther from every measured posture than that spacing: an extrapolation. A map of
                                  // one posture cannot tell.
};

// One physical mode through the map: its measurement at each posture, directions with signs that agree, or nothing
// where a posture lacks it.
using ModeTrack = std::vector<std::optional<Mode>>;

// Tells which modes of different postures are the same physical mode. Each posture is compared with its nearest
// neighbour along the shortest tree through the map, so that modes change little in each comparison; pairs are taken
// best first, by difference in log frequency and in direction. Where all postures have the same number of modes, so
// many tracks result.
std::vector<ModeTrack> match_modes(const DynamicsMap& map, const JointScale& scale = kEqualJoints);

// Predicts the modes at a posture. At a measured posture it returns that measurement exactly. With `modal`, a mode that
// some postures lack is predicted where those that have it hold at least half of the weight. Throws
// std::invalid_argument as inverse_distance_weights does, and for a mode in the map that is not physical.
PredictedPosture predict_posture(const DynamicsMap& map, const Posture& query, const Interpolation& interpolation);

}  // namespace stillcut
