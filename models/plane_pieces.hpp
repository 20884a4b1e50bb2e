// Pieces of the plane, areas with holes: where the tool's centre may be in a region, and what is left of an area when
// it shrinks by the step from one pass to the next. All that tool path patterns (models/path_patterns) ask of Clipper.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "models/contour.hpp"
#include "models/region.hpp"

namespace stillcut {

// The outer contour counter-clockwise, holes clockwise: the area lies to the left of all.
struct PlanePiece {
  Contour outer;
  std::vector<Contour> holes;
};

using PlanePieces = std::vector<PlanePiece>;

// How far a chord may leave the arc that it stands for, m.
inline constexpr double kChordTolerance = 10e-6;
// What is narrower, m, is none: rounding leaves or takes it.
inline constexpr double kLeastWidth = 10e-6;

// Where the centre of a tool of this radius, m, may be: `radius` away from the islands and from the polygon, or, where
// it may overhang the polygon, up to the polygon. Empty: nowhere.
PlanePieces tool_centre_pieces(const Region& region, double radius, bool overhang);

// What is at least a distance, m, away from everything outside the pieces.
PlanePieces shrunk(std::span<const PlanePiece> pieces, double distance);

// What is within a distance, m, of the pieces.
PlanePieces grown(std::span<const PlanePiece> pieces, double distance);

PlanePieces subtracted(std::span<const PlanePiece> pieces, std::span<const PlanePiece> taken);

PlanePieces common_to(std::span<const PlanePiece> pieces, std::span<const PlanePiece> others);

// What a disc covers that goes along open lines.
PlanePieces swept_by_disc(std::span<const Contour> lines, double radius);

bool encloses(const PlanePiece& piece, const Eigen::Vector2d& point);

// Whether the straight line between two points stays in the piece, its edge included; 1 um beyond it does not count.
bool stays_inside(const PlanePiece& piece, const Eigen::Vector2d& from, const Eigen::Vector2d& to);

// All contours of a piece, the outer one first.
std::vector<Contour> contours_of(const PlanePiece& piece);

}  // namespace stillcut
