// The whole stability diagram as a grid of speeds and depths: how strongly each cut grows or decays, or only whether it
// is stable. Shows what a depth limit cannot: islands, and stable windows above the limit.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "models/floquet.hpp"

namespace stillcut {

// Spectral radius at every speed (rad/s) and depth (m, rising): speed by speed, depths side by side. Within
// max(1e-5, tolerance) of max(1, radius). Throws as floquet_point.
std::vector<double> spectral_radii(const LinearCut& cut, std::span<const Mode> feed_frame_modes,
                                   std::span<const double> speeds, std::span<const double> depths,
                                   double tolerance = 1e-5);

// 1 where a cut is stable, 0 where it is not, in the same order. The first speed is solved at every depth; at the next
// ones the boundaries found are followed, and what lies between them is looked at in a few depths, others at each
// speed. Where a look contradicts, that speed and those before it are searched anew. An island smaller than about 4
// grid points can be missed. Throws as above.
std::vector<std::uint8_t> stable_cuts(const LinearCut& cut, std::span<const Mode> feed_frame_modes,
                                      std::span<const double> speeds, std::span<const double> depths);

}  // namespace stillcut
