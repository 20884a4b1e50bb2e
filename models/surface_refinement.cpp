#include "models/surface_refinement.hpp"

#include <Eigen/Core>
#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace stillcut {
namespace {

// Points around the middle, so that the normal equations stay well conditioned.
Eigen::Vector3d plane_terms(const HeightMap& map, std::size_t i, std::size_t j) {
  return {1.0, static_cast<double>(i) / static_cast<double>(map.along) - 0.5,
          static_cast<double>(j) / static_cast<double>(map.across) - 0.5};
}

template <typename Point>
void for_each_height(const HeightMap& map, Point point) {
  for (std::size_t j = 0; j < map.across; ++j)
    for (std::size_t i = 0; i < map.along; ++i)
      if (!std::isnan(map.at(i, j))) point(plane_terms(map, i, j), map.at(i, j));
}

}  // namespace

double arithmetic_deviation(const HeightMap& map) {
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
  Eigen::Vector3d moments = Eigen::Vector3d::Zero();
  for_each_height(map, [&](const Eigen::Vector3d& terms, double height) {
    squares += terms * terms.transpose();
    moments += terms * height;
  });
  const double points = squares(0, 0);
  if (points < 3.0) return std::numeric_limits<double>::quiet_NaN();
  const Eigen::Vector3d plane = squares.inverse() * moments;
  double sum = 0.0;
  for_each_height(map,
                  [&](const Eigen::Vector3d& terms, double height) { sum += std::abs(height - plane.dot(terms)); });
  return sum / points;
}

SweepCount sweep_all(const SurfaceSweep& sweep, HeightMap& map, std::span<const CutterPass> passes,
                     const Workers& workers) {
  const std::vector<MapTile> tiles = map_tiles(map);
  std::vector<SweepCount> counts(tiles.size());
  const auto task = [&](std::size_t i) { counts[i] = sweep.sweep(map, tiles[i], passes); };
  if (workers) {
    workers(tiles.size(), task);
  } else {
    for (std::size_t i = 0; i < tiles.size(); ++i) task(i);
  }
  SweepCount total;
  for (const SweepCount& count : counts) {
    total.patches += count.patches;
    total.heights += count.heights;
  }
  return total;
}

RefinedSurface refined_surface(const CutterMotion& motion, const Cut& cut, std::span<const CutterPass> passes,
                               const RefinementSetup& setup) {
  if (!(setup.tolerance > 0.0)) throw std::invalid_argument("tolerance: must be positive");
  RefinedSurface surface;
  surface.error = std::numeric_limits<double>::infinity();
  for (double spacing = setup.spacing > 0.0 ? setup.spacing : coarsest_spacing(cut); !surface.converged;
       spacing *= 0.5) {
    const double points = (setup.along / spacing + 1.0) * (setup.across / spacing + 1.0);
    if (!surface.map.heights.empty() && points > static_cast<double>(setup.most_points)) break;
    HeightMap map = uncut_map(setup.along, setup.across, spacing);
    const SurfaceSweep sweep(motion, cut, map.spacing_along, map.spacing_across, setup.allow_coarse);
    sweep_all(sweep, map, passes, setup.workers);
    const double figure = setup.figure(map), change = std::abs(figure - surface.figure);
    // A flat surface has no roughness to compare with: what rounding leaves of one is below a picometre.
    if (!surface.map.heights.empty()) surface.error = change / std::max(std::abs(figure), 1e-12);
    surface.map = std::move(map);
    surface.figure = figure;
    surface.converged = surface.error <= setup.tolerance;
  }
  return surface;
}

}  // namespace stillcut
