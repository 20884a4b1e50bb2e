// The passes of tool path patterns over one piece of where the tool's centre may be; models/path_patterns joins them.
#pragma once

#include <vector>

#include "models/path_patterns.hpp"
#include "models/plane_pieces.hpp"

namespace stillcut {

// What is cut without a link or a rapid move.
struct PatternPass {
  Contour points;  // m, open: a loop ends with its first point
  Milling milling = Milling::unknown;
};

// Lines along an angle, rad (models/pattern_lines).
std::vector<PatternPass> line_passes(const PlanePiece& piece, bool zig_zag, double angle,
                                     const PatternSettings& settings);

// Loops from walls inward, the first from the place nearest to `start`; blended into each other for a spiral
// (models/pattern_loops).
std::vector<PatternPass> loop_passes(const PlanePiece& piece, bool spiral, const Eigen::Vector2d& start,
                                     const PatternSettings& settings);

}  // namespace stillcut
