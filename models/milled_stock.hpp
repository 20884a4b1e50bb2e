// The part that passes with a ball end are milled into: a map of heights over the surface, as what came before the
// first pass has left it, coarse, for chips and forces rather than for roughness.
#pragma once

#include <span>

#include "models/cutter_motion.hpp"
#include "models/height_map.hpp"

namespace stillcut {

struct Stock {
  HeightMap map;                          // heights over the surface, m
  double origin_x = 0.0, origin_y = 0.0;  // m, of its point (0, 0), map axes
};

// How far from its middle a ball still meets stock of this depth, m.
[[nodiscard]] double contact_reach(const Tool& tool, double axial_depth);

// How far before the end of a pass the ball meets what the neighbour, which ended there too, has left ahead of it, m.
[[nodiscard]] double end_reach(const Tool& tool, const Cut& cut);

// Stock of the cut's depth under all of the passes, in the order in which they are milled, with the grooves of the
// passes before the first one.
[[nodiscard]] Stock stock_for(const Tool& tool, const Cut& cut, std::span<const CutterPass> passes);

// Takes away what the ball has cut of a pass before its begin, so that the pass begins in the middle of a cut. The ball
// is larger by the tool's runout: a tooth that found too much would strike, one that finds too little has no more to do
// than that for a turn.
void cut_up_to_begin(const Tool& tool, const CutterPass& pass, Stock& stock);

}  // namespace stillcut
