// Zeroth-order (single-frequency) stability lobes of Altintas and Budak: the mean of the cutting stiffness over a turn,
// so a fast first look. It cannot see flip lobes and is far off when structural modes lie near the tooth-passing
// frequency; what the runtime trusts is models/floquet.hpp.
#pragma once

#include <Eigen/Core>
#include <array>
#include <complex>
#include <functional>
#include <span>
#include <vector>

#include "models/depth_limit.hpp"
#include "models/dynamics_map.hpp"
#include "models/linear_cut.hpp"

namespace stillcut {

// What one eigenvalue of the oriented receptance says, Lambda = -1/eigenvalue with det[I + Lambda G_0] = 0:
//   depth = -(2 pi Re(Lambda) / (N k_tc)) (1 + (Im/Re)^2), phase = pi - 2 atan2(Im(Lambda), Re(Lambda)), modulo 2 pi.
// A lobe exists where depth is positive; its speeds are 2 pi frequency / (N (phase + 2 pi k)), k = 0, 1, 2 ...
// (Conjugating Lambda would mirror the lobes.)
struct LobeBranch {
  double depth = 0.0;  // m
  double phase = 0.0;  // rad, in [0, 2 pi)
};
LobeBranch lobe_branch(const LinearCut& cut, std::complex<double> oriented_eigenvalue);

// Eigenvalues of the oriented receptance G_0 = alpha G at a chatter frequency (rad/s), alpha the directional
// coefficients over the immersion (docs/conventions.md), G the 2 x 2 receptance in the feed plane with its cross terms.
std::array<std::complex<double>, 2> oriented_eigenvalues(const LinearCut& cut, std::span<const Mode> feed_frame_modes,
                                                         double frequency);

// The same of a receptance given as such, 2 x 2 in the feed plane, m/N.
std::array<std::complex<double>, 2> oriented_eigenvalues(const LinearCut& cut, const Eigen::Matrix2cd& receptance);

// Depth limits at the given speeds (rad/s): the lower envelope over both eigenvalues and all lobes that cross each
// speed. Chatter frequencies up to four times the highest mode are searched. Depths above max_depth are +inf. Throws
// std::invalid_argument for speeds, depth or modes out of range.
std::vector<DepthLimit> zeroth_order_limits(const LinearCut& cut, std::span<const Mode> feed_frame_modes,
                                            std::span<const double> speeds, double max_depth);

// The same for a receptance that is not that of modes in the feed frame (models/paper_projection.hpp): m/N at a
// frequency in rad/s. `modes` tell where it turns, in whatever axes.
using FeedReceptance = std::function<Eigen::Matrix2cd(double frequency)>;
std::vector<DepthLimit> zeroth_order_limits(const LinearCut& cut, std::span<const Mode> modes,
                                            const FeedReceptance& receptance, std::span<const double> speeds,
                                            double max_depth);

}  // namespace stillcut
