// How rough the wall is that a simulated cut leaves: each tooth, where it passes the wall, leaves an arc as deep as it
// reaches there, vibration and runout included, and the arcs that reach deepest remain.
#pragma once

#include <span>

namespace stillcut {

struct ToothPass {
  double along = 0.0;  // m along the wall, rising
  double reach = 0.0;  // m into the part, from the programmed wall
};

// Mean roughness Ra, m: mean over sampling lengths of 0.8 mm (ISO 4288, Ra 0.1 to 2 um) of the mean distance from the
// least-squares line. NaN where the wall is shorter than one sampling length.
[[nodiscard]] double wall_roughness(std::span<const ToothPass> passes, double tool_radius);

}  // namespace stillcut
