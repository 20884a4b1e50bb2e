// Cuts whose surface is swept, and what is measured of it.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "models/surface_roughness.hpp"
#include "models/surface_sweep.hpp"

namespace stillcut::test {

struct SweptCut {
  Tool tool{.shape = ToolShape::ball, .diameter = 8e-3, .teeth = 2, .pitch = {kTwoPi / 2, kTwoPi / 2}};
  Cut cut{.radial_depth = 0.4e-3, .axial_depth = 0.5e-3, .feed_per_tooth = 0.1e-3, .spindle_speed = rpm_to_rad_s(6000)};
  double along = 1e-3, across = 0.8e-3, spacing = 4e-6;
  Displacement displacement;
  // Each pass begins with the phase that lets its marks go on from its neighbour's: an edge crosses the contact as a
  // line, so that marks of one pass lie slanted.
  bool aligned = false;
};

inline std::vector<CutterPass> passes_of(const SweptCut& swept_cut, const CutterMotion& motion) {
  auto passes = passes_over(motion, swept_cut.cut, swept_cut.along, swept_cut.across);
  if (!swept_cut.aligned) return passes;
  const double sine = std::sin(motion.inclination());
  for (CutterPass& pass : passes)
    pass.angle = pass.across * motion.orientation(0, 2) / (0.5 * swept_cut.tool.diameter * sine * sine);
  return passes;
}

inline HeightMap swept(const SweptCut& swept_cut) {
  const CutterMotion motion = cutter_motion(swept_cut.tool, swept_cut.cut, swept_cut.displacement);
  HeightMap map = uncut_map(swept_cut.along, swept_cut.across, swept_cut.spacing);
  const SurfaceSweep sweep(motion, swept_cut.cut, map.spacing_along, map.spacing_across);
  const auto passes = passes_of(swept_cut, motion);
  for (const MapTile& tile : map_tiles(map)) sweep.sweep(map, tile, passes);
  return map;
}

inline std::vector<double> row_along(const HeightMap& map, std::size_t j) {
  const auto begin = map.heights.begin() + static_cast<std::ptrdiff_t>(j * map.along);
  return {begin, begin + static_cast<std::ptrdiff_t>(map.along)};
}

inline std::vector<double> row_across(const HeightMap& map, std::size_t i) {
  std::vector<double> row;
  for (std::size_t j = 0; j < map.across; ++j) row.push_back(map.at(i, j));
  return row;
}

inline double ra_along(const HeightMap& map) { return mean_roughness(map, ProfileDirection::along).mean.ra; }

inline double ra_across(const HeightMap& map) { return mean_roughness(map, ProfileDirection::across).mean.ra; }

}  // namespace stillcut::test
