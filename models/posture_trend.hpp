// Weights that follow a slope. Plain inverse distance weights pull every prediction toward the mean of the map: they
// reproduce a constant and nothing else. These reproduce a plane through the postures: of all sets of weights they are
// those of the least-squares plane in which each posture's residual counts with its inverse distance weight (Shepard's
// weights made first-order consistent; Lancaster and Salkauskas 1981, moving least squares of degree 1).
#pragma once

#include <span>
#include <vector>

#include "models/posture.hpp"

namespace stillcut {

// One weight per posture, summing to 1; some may be negative. `weights` are those of inverse_distance_weights, perhaps
// with zeros for postures to leave out; their sum must be positive. With x_i the postures seen from the query (rad or
// m, angles compared as angles):
//
//     l_i = s_i (1 - m^T C^-1 (x_i - m)),   m = sum s_i x_i,   C = sum s_i (x_i - m)(x_i - m)^T,
//     s_i = w_i^2 / sum w^2
//
// A plane needs directions in which the map extends: the x_i are first reduced to the principal directions along which
// the postures in use spread at least a tenth as far as along the widest, and to one direction for every two postures
// beyond the first. With fewer the plain weights come back. At a measured posture that one has all the weight.
std::vector<double> trend_weights(const DynamicsMap& map, const Posture& query, std::span<const double> weights,
                                  const JointScale& scale = kEqualJoints);

// In how many directions the map's postures spread at least a tenth as far as in the widest: a slope in all of them
// takes two postures for each, and one. 0 for a single posture.
int spread_directions(const DynamicsMap& map, const JointScale& scale = kEqualJoints);

}  // namespace stillcut
