// The way back of an axis that starts beyond its limits, or cannot help passing its speed limit: the fastest return to
// the states from which every limit can be kept.
#pragma once

#include "rt/extremal_moves.hpp"

namespace stillcut {

// Divided by the jerk limit, as in extremal_moves.hpp: a ramp at jerk `jerk`, then a hold at the acceleration reached.
struct Brake {
  double jerk = 0.0;              // 1, -1; 0: none is needed
  double ramp = 0.0, hold = 0.0;  // s
  double acceleration = 0.0;      // at the end of the ramp
};

// Of `move`, the start and the limits are used.
[[nodiscard]] Brake brake_of(const AxisMove& move) noexcept;

}  // namespace stillcut
