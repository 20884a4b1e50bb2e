// The surface that a milling cutter leaves, on a grid of heights (Z-map; Liu et al. 2024, section 2.4). Between two
// time steps each piece of an edge sweeps a patch, two triangles; every grid point under it takes the patch's height
// there if that is lower. Swept patches, unlike swept points, leave no gap that a scratch could fall through.
//
// What a tile gets does not depend on the other tiles, nor on the order of the patches: tiles are the parallel unit,
// and the heights are the same, bit for bit, however the map is tiled.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "models/cutter_envelope.hpp"
#include "models/cutter_motion.hpp"
#include "models/edge_rows.hpp"
#include "models/edge_sheet.hpp"
#include "models/height_map.hpp"
#include "models/swept_patches.hpp"

namespace stillcut {

// The coarsest grid that shows feed marks and scallops: a fifth of the smaller of feed per tooth and step-over, m.
[[nodiscard]] double coarsest_spacing(const Cut& cut);

// The passes that leave the surface over x = 0 to `along`, y = 0 to `across`, as a machine makes them one after the
// other, with room for the tool to run in and out; one of them lies on y = 0.
[[nodiscard]] std::vector<CutterPass> passes_over(const CutterMotion& motion, const Cut& cut, double along,
                                                  double across, double turn_time = 0.0);

class SurfaceSweep {
 public:
  // For maps of these spacings whose point (0, 0) lies at x = y = 0. Throws std::invalid_argument, in words for the
  // user, for what swept_heights() refuses and for spacings coarser than coarsest_spacing(), unless that is allowed.
  SurfaceSweep(CutterMotion motion, const Cut& cut, double spacing_along, double spacing_across,
               bool allow_coarse = false);

  // Lowers the heights of a tile to what the passes leave there. Different tiles of a map may be cut at the same time.
  SweepCount sweep(HeightMap& map, const MapTile& tile, std::span<const CutterPass> passes) const;

 private:
  // Steps of a turn in which some of an edge is low, the last may lie in the next turn; and where, in points of the map
  // from the tool's position.
  struct Window {
    std::int64_t first = 0, last = 0;
    double low_x = 0.0, high_x = 0.0, low_y = 0.0, high_y = 0.0;
  };
  struct Sheet;
  void place_edge_points(double spacing);
  void find_windows();
  [[nodiscard]] std::vector<EdgeRange> low_points() const;
  [[nodiscard]] bool touches(const CutterPass& pass, double begun, const Window& window, const MapTile& tile) const;
  void place(const CutterPass& pass, std::size_t tooth, std::int64_t step, const EdgeRows& edge, EdgeRow& row) const;

  CutterMotion motion_;
  SweptHeights swept_;
  double spacing_along_, spacing_across_;
  std::int64_t steps_per_turn_ = 0;
  EdgeRows points_, knots_;
  std::array<std::vector<double>, 3> sag_;  // of the pieces between knots, in the units of an edge
  std::vector<EdgeRange> ranges_;           // of each step of a turn
  std::vector<Window> windows_;
};

}  // namespace stillcut
