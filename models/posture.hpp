// Postures and how far apart they are: in joint space where the machine has joints, in space where it has none.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "models/dynamics_map.hpp"

namespace stillcut {

using JointScale = std::array<double, 6>;  // how much each joint's angle counts; 1 is the paper's plain distance
inline constexpr JointScale kEqualJoints{1, 1, 1, 1, 1, 1};

// Distance in rad (has_joints: Euclidean over joint angles compared as angles, so 359 and 1 degree are 2 degrees apart;
// surface paper, eq. 17) or in m.
double posture_distance(const Posture& a, const Posture& b, bool has_joints, const JointScale& scale = kEqualJoints);

// Such a distance for users: "12.5 deg" or "34 mm", three digits.
std::string posture_distance_text(double distance, bool has_joints);

// The weight of every posture of the map for a query: 1/d^p, divided by their sum (surface paper, eq. 18). A query that
// stands on a measured posture (d = 0) gives that one all the weight. Throws std::invalid_argument for an empty map, a
// power that is not positive, or a query that is not finite.
std::vector<double> inverse_distance_weights(const DynamicsMap& map, const Posture& query, double power,
                                             const JointScale& scale = kEqualJoints);

// A posture from what a user writes: the id of a measured one, "j1,...,j6" in degrees, or, for a map without joints,
// "x,y,z" in mm. Throws std::invalid_argument, with what would be right, otherwise.
Posture find_posture(const DynamicsMap& map, std::string_view text);

}  // namespace stillcut
