// Tool path patterns over a region, as CAM packages offer them (Tunc and Stoddart 2017, section 5.2, Fig. 7), for a
// spindle that turns clockwise seen from above: in down milling what is not cut yet lies to the right of the travel.
#pragma once

#include <limits>
#include <optional>
#include <string>

#include "models/region.hpp"
#include "models/tool_path.hpp"

namespace stillcut {

enum class PatternKind { zig, zig_zag, periphery_in, periphery_out, spiral_in, spiral_out };

// A part of the plane, up to infinity where it has no border, m.
struct PatternWindow {
  double x_begin = -std::numeric_limits<double>::infinity(), x_end = std::numeric_limits<double>::infinity();
  double y_begin = x_begin, y_end = x_end;
};

struct PatternSettings {
  double tool_radius = 0.0;               // m
  double step_over = 0.0;                 // m, up to the tool's diameter
  double z = 0.0;                         // m, of the tip
  double clearance = 5e-3;                // m, above z: where rapid moves go
  Milling milling = Milling::down;        // or up
  bool face = false;                      // the tool's centre goes up to the polygon, so that the tool overhangs it
  std::optional<PatternWindow> window{};  // only where the tool's centre is in it; a path without moves where it is
                                          // nowhere in it
};

// The path that fills the region. Each piece that the tool's centre can stay in is machined after the other.
//   zig           lines along the angle (rad, from +X toward +Y), equally spaced, the outermost at the edge; all in one
//                 sense, side by side so that the milling kind holds
//   zig_zag       the same lines in alternating sense: down and up milling take turns
//   periphery in  the edge of where the tool's centre may be, then its offsets by the step over, from walls inward
//   periphery out the same from the middle outward
//   spiral in/out the same, each loop blended into the next over one turn where one lies within the other; the
//                 first and the last loop are whole
// Lines leave cusps at walls that they end at or that are oblique to them, as they do in CAM; where they leave more of
// the piece than that uncut, lines are added between them. Loops leave nothing that the tool can reach.
//
// Cutting moves have the milling kind; links from pass to pass in the material, which cut to both sides, have slot. The
// first pass of a piece has its pattern's kind. Rapid moves (up, across at the clearance, down) are not cutting, nor is
// the plunge: a vertical feed move, but only moves in the plane are cuts to be rated.
//
// Throws std::invalid_argument where the region has a fault, a setting is out of range, or the tool does not fit.
ToolPath make_pattern(const Region& region, PatternKind kind, double angle, const PatternSettings& settings);

// "zig 45", "zig-zag 22.5", "periphery in", "spiral out"; the angle in rad.
std::string pattern_name(PatternKind kind, double angle);

}  // namespace stillcut
