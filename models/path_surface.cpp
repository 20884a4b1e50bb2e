#include "models/path_surface.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <stdexcept>
#include <string>

namespace stillcut {
namespace {

constexpr double kLightTouch = 10e-6;  // m that a rapid may pass below the surface unmentioned

// What is found in a tile.
struct TileFindings {
  std::size_t uncovered = 0, on_shank = 0, struck = 0;
  double deepest_strike = 0.0;
  std::size_t shank_piece = 0, strike_piece = 0;
  SweepCount count;
};

void clear_shank(HeightMap& map, const MapTile& tile, std::span<const EnvelopePoint> envelope, TileFindings& found) {
  std::size_t n = 0;
  for (std::size_t j = tile.across_begin; j < tile.across_end; ++j)
    for (std::size_t i = tile.along_begin; i < tile.along_end; ++i, ++n) {
      double& height = map.at(i, j);
      if (envelope[n].kappa >= 0.5 * std::numbers::pi) {
        height = std::numeric_limits<double>::quiet_NaN();
        found.shank_piece = envelope[n].piece;
        ++found.on_shank;
      } else if (std::isnan(height)) {
        ++found.uncovered;
      }
    }
}

void store(std::span<const EnvelopePoint> envelope, const MapTile& tile, HeightMap& map) {
  std::size_t n = 0;
  for (std::size_t j = tile.across_begin; j < tile.across_end; ++j)
    for (std::size_t i = tile.along_begin; i < tile.along_end; ++i, ++n) map.at(i, j) = envelope[n].height;
}

void find_strikes(const HeightMap& map, const MapTile& tile, const Eigen::Vector2d& origin,
                  std::span<const BallStroke> air, double light, TileFindings& found) {
  double highest = -std::numeric_limits<double>::infinity();
  for (std::size_t j = tile.across_begin; j < tile.across_end; ++j)
    for (std::size_t i = tile.along_begin; i < tile.along_end; ++i)
      if (!std::isnan(map.at(i, j))) highest = std::max(highest, map.at(i, j));
  const double half_x = 0.5 * map.spacing_along * static_cast<double>(tile.along_end - 1 - tile.along_begin),
               half_y = 0.5 * map.spacing_across * static_cast<double>(tile.across_end - 1 - tile.across_begin);
  const double x = origin.x() + map.spacing_along * static_cast<double>(tile.along_begin) + half_x,
               y = origin.y() + map.spacing_across * static_cast<double>(tile.across_begin) + half_y;
  std::vector<BallStroke> near;
  for (const BallStroke& stroke : air)
    if (lowest_in_box(stroke, x, y, half_x, half_y) < highest - light) near.push_back(stroke);
  if (near.empty()) return;
  for (std::size_t j = tile.across_begin; j < tile.across_end; ++j)
    for (std::size_t i = tile.along_begin; i < tile.along_end; ++i) {
      double deepest = light;
      std::size_t piece = 0;
      for (const BallStroke& stroke : near) {
        const StrokeLow low = lowest_over(stroke, origin.x() + static_cast<double>(i) * map.spacing_along,
                                          origin.y() + static_cast<double>(j) * map.spacing_across);
        if (map.at(i, j) - low.height > deepest) deepest = map.at(i, j) - low.height, piece = stroke.piece;
      }
      if (!(deepest > light)) continue;
      ++found.struck;
      if (deepest > found.deepest_strike) found.deepest_strike = deepest, found.strike_piece = piece;
    }
}

}  // namespace

PathWindow middle_of(const CutterPath& path, double along, double across) {
  Eigen::Array2d low = Eigen::Array2d::Constant(std::numeric_limits<double>::infinity()), high = -low;
  for (const PathPiece& piece : path.pieces) {
    if (!piece.cuts) continue;
    for (const double elapsed : {0.0, piece.duration}) {
      const Eigen::Array2d centre = ball_pose(path, piece, elapsed).centre.head<2>();
      low = low.min(centre), high = high.max(centre);
    }
  }
  if (!(low.x() <= high.x())) throw std::invalid_argument("tool path: no move of it cuts");
  const Eigen::Array2d middle = 0.5 * (low + high);
  return {middle.x() - 0.5 * along, middle.y() - 0.5 * across, along, across};
}

PathSurface path_surface(const CutterPath& path, const PathWindow& window, const PathSurfaceSetup& setup) {
  PathSurface surface;
  surface.origin = {window.x, window.y};
  surface.map = uncut_map(window.along, window.across, setup.spacing > 0.0 ? setup.spacing : coarsest_spacing(path));
  if (setup.keep_envelope) surface.envelope = surface.map;
  const PathSweep sweep(path, surface.map, surface.origin, setup.allow_coarse);
  const std::vector<BallStroke> air = path_strokes(path, false, 0.1 * kLightTouch);
  const double light = kLightTouch + farthest_beside(path);

  const std::vector<MapTile> tiles = map_tiles(surface.map);
  std::vector<TileFindings> findings(tiles.size());
  const auto cut_tile = [&](std::size_t n) {
    const MapTile& tile = tiles[n];
    TileFindings& found = findings[n];
    found.count = sweep.sweep(surface.map, tile);
    const std::vector<EnvelopePoint> envelope = sweep.envelope().over(surface.map, tile);
    clear_shank(surface.map, tile, envelope, found);
    if (setup.keep_envelope) store(envelope, tile, surface.envelope);
    find_strikes(surface.map, tile, surface.origin, air, light, found);
  };
  if (setup.workers) {
    setup.workers(tiles.size(), cut_tile);
  } else {
    for (std::size_t n = 0; n < tiles.size(); ++n) cut_tile(n);
  }

  for (const TileFindings& found : findings) {
    surface.uncovered += found.uncovered;
    surface.on_shank += found.on_shank;
    if (found.on_shank > 0) surface.shank_line = path.pieces[found.shank_piece].line;
    surface.struck += found.struck;
    if (found.deepest_strike > surface.deepest_strike) {
      surface.deepest_strike = found.deepest_strike;
      surface.strike_line = path.pieces[found.strike_piece].line;
    }
    surface.count.patches += found.count.patches;
    surface.count.heights += found.count.heights;
  }
  if (surface.on_shank > 0 && surface.on_shank + surface.uncovered == surface.map.heights.size())
    throw std::invalid_argument("tool path, line " + std::to_string(surface.shank_line) +
                                ": the tool leans so far that its shank makes the surface, not its ball; tilt it less");
  return surface;
}

}  // namespace stillcut
