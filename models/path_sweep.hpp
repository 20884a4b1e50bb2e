// The surface that a ball-end cutter leaves as it follows a tool path, on a grid of heights over workpiece X and Y.
// As SurfaceSweep, for a tool whose way, axis, feed and speed change from move to move, on surfaces of any form. There
// no height is known from the start that edges must come below: of each turn the ball is held against the heights that
// a tile already has, those turns first that go deepest, and only what may still cut is swept.
//
// Heights do not depend on the tiles nor on their order, bit for bit.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "models/contact_window.hpp"
#include "models/cutter_path.hpp"
#include "models/edge_sheet.hpp"
#include "models/height_map.hpp"
#include "models/path_envelope.hpp"

namespace stillcut {

class PathSweep {
 public:
  // For maps of these points and spacings whose point (0, 0) lies at `origin`, m in workpiece X and Y. Throws
  // std::invalid_argument, in words for the user, where the path does not come to the map, and for spacings coarser
  // than coarsest_spacing(), unless that is allowed.
  PathSweep(CutterPath path, const HeightMap& map, const Eigen::Vector2d& origin, bool allow_coarse = false);

  PathSweep(const PathSweep&) = delete;  // its envelope looks at its path
  PathSweep& operator=(const PathSweep&) = delete;

  // Lowers the heights of a tile to what the path leaves there. Different tiles of a map may be cut at the same time.
  SweepCount sweep(HeightMap& map, const MapTile& tile) const;

  [[nodiscard]] const CutterPath& path() const { return path_; }
  [[nodiscard]] const PathEnvelope& envelope() const { return envelope_; }

 private:
  // At most a turn of the spindle within one piece of the path.
  struct Stretch {
    std::size_t piece = 0;
    double begin = 0.0, end = 0.0;  // rad, the spindle's
    bool comes_on = false;          // without a gap from what is before
    BallStroke body;                // runout and vibration included
    double lowest = 0.0;            // m, over the tile
    int order = 0;
  };
  using Edge = std::array<std::vector<double>, 3>;  // radius cos lag, radius sin lag, height; m
  struct Sheet;

  void choose_steps(const HeightMap& map);
  void place_edge_points(double spacing);
  [[nodiscard]] double axis_turn(const Stretch& stretch) const;
  [[nodiscard]] std::vector<Stretch> stretches_over(const MapTile& tile) const;
  [[nodiscard]] ContactWindow contact(const Stretch& stretch, const PatchCanvas& canvas) const;
  void place(std::size_t piece, std::size_t tooth, std::int64_t step, const Edge& edge, EdgeRow& row) const;

  CutterPath path_;
  PathEnvelope envelope_;
  Eigen::Vector2d origin_;
  double spacing_along_, spacing_across_;
  std::int64_t steps_per_turn_ = 0;
  double stray_ = 0.0;             // m, how far an edge can be beside the turning ball
  std::vector<EdgePoint> points_;  // equally spaced in kappa, from the tip to a right angle
  Edge columns_, knots_;
  std::vector<double> sag_;  // m, of the pieces between knots
};

}  // namespace stillcut
