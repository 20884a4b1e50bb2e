// The stability boundary followed from speed to speed: each limit starts from what the speeds before it promise, so
// that a diagram costs a few solutions a speed and can follow a moving arm.
#pragma once

#include <span>
#include <vector>

#include "models/depth_limit.hpp"
#include "models/floquet.hpp"

namespace stillcut {

struct TraceSettings {
  double max_depth = 0.02;  // m
  double tolerance = 5e-4;  // relative, of a limit
  int level = 0;            // resolution(level)
};

// Depth limits at rising speeds (rad/s) that lie close together (a few per cent of a lobe's width). The same limits as
// floquet_depth_limit, with `tolerance`. Below each limit the cut is looked at in a few depths, others at each speed;
// where that or the boundary itself shows an unstable island, the speed is searched in full, and so are its neighbours
// back to where the island began. An island that covers fewer than three speeds can be missed. Throws as
// floquet_depth_limit.
std::vector<DepthLimit> traced_depth_limits(const LinearCut& cut, std::span<const Mode> feed_frame_modes,
                                            std::span<const double> speeds, const TraceSettings& settings);

}  // namespace stillcut
