// The last step of a modal refit: moves a few modes until their receptance is nearest to a given one.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "models/dynamics_map.hpp"

namespace stillcut {

// Levenberg-Marquardt over log frequency, log damping ratio and v = u/sqrt(k) of every mode (so frequency, damping and
// stiffness stay positive whatever the step) for the sum over `frequencies` (rad/s) of
//
//     norm(G_modes - G)^2 / norm(G)^2,   Frobenius norms, `responses` the G (m/N) at each frequency.
//
// The result is never farther off than the start.
std::vector<Mode> polish_modes(std::vector<Mode> modes, std::span<const double> frequencies,
                               std::span<const Eigen::Matrix3cd> responses);

}  // namespace stillcut
