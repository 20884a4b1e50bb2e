// The wall that a simulated cut of an end mill leaves: each tooth, where it passes the wall, leaves an arc as deep as
// it reaches there, vibration and runout included, and the arcs that reach deepest remain.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace stillcut {

struct ToothPass {
  double along = 0.0;  // m along the wall, rising
  double reach = 0.0;  // m into the part, from the programmed wall
};

// How far into the part the wall is cut at `count` points, `spacing` apart from `from` on, m; NaN where no tooth passed
// nearby. Passes in rising order.
[[nodiscard]] std::vector<double> wall_heights(std::span<const ToothPass> passes, double tool_radius, double from,
                                               double spacing, std::size_t count);

}  // namespace stillcut
