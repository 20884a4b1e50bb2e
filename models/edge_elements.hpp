// The cutting edge as short pieces along the tool's profile, from the tip up to the depth of cut: what each piece cuts,
// which way it faces and how far the helix makes it trail.
#pragma once

#include <vector>

#include "models/machining.hpp"

namespace stillcut {

// All pieces of an edge have the same chip width, measured along the profile: dz for an end mill, dz / sin kappa on a
// ball (docs/conventions.md). kappa is the angle from the tool's axis to the piece's normal; at an end mill, and above
// a ball, it is a right angle.
struct EdgeElement {
  double lag = 0.0;                         // rad that the piece trails the tip
  double sin_kappa = 1.0, cos_kappa = 0.0;  // normal: outward sin kappa, down cos kappa
  double chip_width = 0.0;                  // m
  double edge_length = 0.0;                 // m, what the edge coefficients act on
};

// Length of the profile from the tip up to a depth, m.
[[nodiscard]] double profile_length(const Tool& tool, double depth);

// How many pieces an edge needs up to a depth (m): neighbours trail by at most two degrees, and a ball has at least
// twelve.
[[nodiscard]] int edge_element_count(const Tool& tool, double depth);

// `count` pieces up to `depth` (m, > 0), from the tip upward. On an end mill the edge coefficients act on the depth of
// cut, on a ball on the length of the edge, as in Altintas and Lee 1996. A ball's edge has a constant lead (surface
// paper, eq. 3).
[[nodiscard]] std::vector<EdgeElement> edge_elements(const Tool& tool, double depth, int count);

}  // namespace stillcut
