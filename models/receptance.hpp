// Receptance of a set of modes at the tool point (m/N), and the same modes seen from the feed frame.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "models/dynamics_map.hpp"

namespace stillcut {

// Throws std::invalid_argument when a mode has no positive frequency or stiffness, a damping ratio outside (0, 1), or
// no direction; or when there is no mode at all.
void check_modes(std::span<const Mode> modes);

// G(w) = sum_r u_r u_r^T / (k_r (1 - (w/w_r)^2 + 2 i zeta_r w/w_r)), 3 x 3, symmetric, in the axes of the modes'
// directions.
Eigen::Matrix3cd receptance(std::span<const Mode> modes, double frequency);

// The modes with their directions turned from workpiece axes into the feed frame: x along the feed, y = z x feed.
// Receptance is a tensor, G_feed = R G R^T, so turning the directions turns every direct and cross response.
// feed_direction in rad from workpiece +X toward +Y.
std::vector<Mode> modes_in_feed_frame(std::span<const Mode> modes, double feed_direction);

}  // namespace stillcut
