// What a tool path leaves in a rectangle of the workpiece: heights, what of the path's own form is in them, and what
// the path does there besides cutting.
#pragma once

#include <Eigen/Core>
#include <cstddef>

#include "models/path_sweep.hpp"
#include "models/surface_refinement.hpp"

namespace stillcut {

// m, workpiece X and Y of the corner that both are smallest of, and what it reaches from there.
struct PathWindow {
  double x = 0.0, y = 0.0, along = 0.0, across = 0.0;
};

// The middle of what the cutting moves come over. Throws std::invalid_argument where none cuts.
[[nodiscard]] PathWindow middle_of(const CutterPath& path, double along, double across);

struct PathSurfaceSetup {
  double spacing = 0.0;  // m, at most; 0: the coarsest allowed
  bool allow_coarse = false;
  bool keep_envelope = false;
  Workers workers{};  // empty: the calling thread alone
};

struct PathSurface {
  HeightMap map;              // m, workpiece Z; NaN where the surface is not known: see below
  HeightMap envelope;         // without teeth, runout and vibration; empty unless it was asked for
  Eigen::Vector2d origin;     // m, workpiece X and Y of point (0, 0)
  std::size_t uncovered = 0;  // points that no move reaches
  std::size_t on_shank = 0;   // points that the tool's shank would make, not its ball
  int shank_line = 0;         // of the file, of a move that makes one
  // Moves in which the tool does not cut, yet passes below the surface: rapids, and feeds with the spindle at rest.
  // They leave no trace in the heights.
  std::size_t struck = 0;       // points
  double deepest_strike = 0.0;  // m
  int strike_line = 0;          // of the file
  SweepCount count;
};

// A strike counts from 10 um and what runout and vibration reach: marks stand up as far above the path.
// Throws std::invalid_argument as PathSweep does, and where the shank would make the whole surface.
[[nodiscard]] PathSurface path_surface(const CutterPath& path, const PathWindow& window, const PathSurfaceSetup& setup);

}  // namespace stillcut
