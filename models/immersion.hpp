// Immersion: the arc over which a tooth is in the part, from the milling kind, the radial depth and the tool's
// diameter.
#pragma once

#include "models/milling_kind.hpp"

namespace stillcut {

// Tooth angles in rad, clockwise from +y of the feed frame (docs/conventions.md); 0 <= entry < exit <= pi.
struct Immersion {
  double entry = 0.0;
  double exit = 0.0;
};

// Up-milling runs from 0 to acos(1 - 2 a_e/D), down-milling from pi - acos(1 - 2 a_e/D) to pi, a slot over 0..pi
// whatever the radial depth (Altintas, Manufacturing Automation, ch. 4). Lengths in m. Throws std::invalid_argument for
// a radial depth outside (0, D], a diameter that is not positive, or an unknown milling kind.
Immersion immersion(Milling milling, double radial_depth, double diameter);

}  // namespace stillcut
