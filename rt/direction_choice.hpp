// Another feed direction: a robot is softer one way than the other, so at the same posture and speed the depth limit
// depends on where the feed goes. Asked for where the path leaves the direction free. Pure function, fit for the loop.
#pragma once

#include "models/lobe_diagram.hpp"
#include "rt/compensation_limits.hpp"

namespace stillcut {

struct DirectionQuestion {
  double direction = 0.0;             // present, rad, workpiece
  double programmed_direction = 0.0;  // rad
  double speed = 0.0;                 // rad/s, that the spindle is to have
  double axial_depth = 0.0;           // m; NaN unknown
  const LobeDiagram* lobes = nullptr;
};

struct DirectionChoice {
  bool found = false;
  bool stable = false;     // predicted so, with the limit's scatter against it
  double direction = 0.0;  // rad, within the freedom about the programmed one
  double margin_before = 0.0;
  double margin_after = 0.0;
};

// Limit at a direction (rad), m: the smaller of the two beside it; NaN without limits over direction.
[[nodiscard]] double depth_limit_towards(const LobeDiagram& diagram, double direction) noexcept;

// The direction of the feed map, where it is within the freedom, predicted stable and better than the present one; else
// the nearest direction predicted stable, else the one predicted best if it is better than the present one. Nothing
// without limits over direction, or where these are for a speed too far from `speed`.
[[nodiscard]] DirectionChoice choose_direction(const DirectionQuestion& question,
                                               const CompensationLimits& limits) noexcept;

}  // namespace stillcut
