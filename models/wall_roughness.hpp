// How rough the wall is that a simulated cut leaves: each tooth, where it passes the wall, leaves an arc as deep as it
// reaches there, vibration and runout included, and the arcs that reach deepest remain.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace stillcut {

struct ToothPass {
  double along = 0.0;  // m along the wall, rising
  double reach = 0.0;  // m into the part, from the programmed wall
};

// How far into the part the wall is cut at `count` points, `spacing` apart from `from` on, m; -inf where no tooth
// passed nearby. Passes in rising order.
[[nodiscard]] std::vector<double> wall_heights(std::span<const ToothPass> passes, double tool_radius, double from,
                                               double spacing, std::size_t count);

inline constexpr double kWallSamplingLength = 0.8e-3;  // m

// Of the sampling length that begins at `from`, m; NaN where the wall does not cover it.
[[nodiscard]] double wall_roughness_at(std::span<const ToothPass> passes, double tool_radius, double from);

// Mean roughness Ra, m: mean over sampling lengths of 0.8 mm (ISO 4288, Ra 0.1 to 2 um) of the mean distance from the
// least-squares line. NaN where the wall is shorter than one sampling length.
[[nodiscard]] double wall_roughness(std::span<const ToothPass> passes, double tool_radius);

}  // namespace stillcut
