// Modes between measured postures, by inverse distance weighting (surface paper, eqs 16-18). Two ways: `frf` weights
// the frequency responses themselves, as the paper does, which superposes the modes of all postures; `modal` weights
// matched modal parameters and keeps the number of modes. `trend` is modal too, with weights that
// reproduce a plane through the map (models/posture_trend) instead of leaning toward its mean.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "models/interpolation_kind.hpp"
#include "models/posture.hpp"

namespace stillcut {

struct Interpolation {
  InterpolationKind kind = InterpolationKind::modal;
  double power = 1.0;
  JointScale joint_scale = kEqualJoints;
};

struct PredictedPosture {
  Posture posture;                // as asked, with the predicted modes in rising frequency
  std::string nearest;            // id of the nearest measured posture
  bool in_joints = false;         // distances are in joint space, rad; otherwise in space, m
  double nearest_distance = 0.0;  // rad or m
  double map_spacing = 0.0;       // the largest distance from a measured posture to its nearest neighbour; 0: only one
  bool outside = false;           // farther from every measured posture than that spacing: an extrapolation. A map of
                                  // one posture cannot tell.
  bool superposed = false;        // by `frf` between postures: the modes are those of all postures, scaled
  std::size_t fitted_from = 0;    // so many superposed modes that posture.modes were fitted to (models/modal_refit);
                                  // 0: they are the prediction itself
  double fit_error = 0.0;         // of that fit: relative, of the receptance, root mean square over the band
};

// One physical mode through the map: its measurement at each posture, directions with signs that agree, or nothing
// where a posture lacks it.
using ModeTrack = std::vector<std::optional<Mode>>;

// Tells which modes of different postures are the same physical mode. Postures are taken in the order of the shortest
// tree through the map, so that modes change little from one to the next; each mode is compared with every track at the
// nearest posture that has it, pairs taken best first, by difference in log frequency and in direction. Where all
// postures have the same number of modes, so many tracks result.
std::vector<ModeTrack> match_modes(const DynamicsMap& map, const JointScale& scale = kEqualJoints);

// Throws std::invalid_argument, naming the posture, for a mode that is not physical (check_modes).
void check_map(const DynamicsMap& map);

// The weighted mean of every matched mode (frequency, damping ratio, stiffness, direction) that the postures with at
// least half of the weight have, in rising frequency. One weight per posture, none negative, sum 1. Throws
// std::invalid_argument where no mode is left.
std::vector<Mode> average_modes(const DynamicsMap& map, std::span<const double> weights,
                                const JointScale& scale = kEqualJoints);

// Predicts the modes at a posture. At a measured posture it returns that measurement exactly. With `modal`, a mode that
// some postures lack is predicted where those that have it hold at least half of the weight. Throws
// std::invalid_argument as inverse_distance_weights does, and for a mode in the map that is not physical.
//
// `trend` interpolates log frequency, log stiffness and log(zeta/(1 - zeta)), so that they stay physical, and never
// goes farther beyond what was measured than the measurements lie apart.
PredictedPosture predict_posture(const DynamicsMap& map, const Posture& query, const Interpolation& interpolation);

// For users, of a prediction that lies outside: how far, in deg or mm, and from which posture.
std::string outside_map_text(const PredictedPosture& predicted);

}  // namespace stillcut
