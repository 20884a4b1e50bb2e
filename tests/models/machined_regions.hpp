// Random regions, and plain geometry of edges and discs to judge tool paths in them: nothing of Clipper.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "models/region.hpp"
#include "models/tool_path.hpp"

namespace stillcut::test {

inline Contour box_mm(double left, double bottom, double right, double top) {
  return {1e-3 * Eigen::Vector2d(left, bottom), 1e-3 * Eigen::Vector2d(right, bottom),
          1e-3 * Eigen::Vector2d(right, top), 1e-3 * Eigen::Vector2d(left, top)};
}

inline Eigen::Vector2d turned(const Eigen::Vector2d& point, double angle) {
  return {point.x() * std::cos(angle) - point.y() * std::sin(angle),
          point.x() * std::sin(angle) + point.y() * std::cos(angle)};
}

inline Region turned(Region region, double angle) {
  for (auto& point : region.polygon) point = turned(point, angle);
  for (Contour& island : region.islands)
    for (auto& point : island) point = turned(point, angle);
  return region;
}

// Convex, L-shaped, rectangular with one or two islands, or a comb of deep arms, at any angle; 100 to 300 mm across.
inline Region random_region(std::mt19937& random, int kind) {
  const auto draw = [&](double low, double high) { return std::uniform_real_distribution<double>(low, high)(random); };
  const double w = draw(150, 300), h = draw(120, 250);
  Region region;
  if (kind % 4 == 0) {
    const double wide = 0.5e-3 * w, high = 0.5e-3 * h;
    const int corners = 3 + static_cast<int>(draw(0, 6));
    for (int i = 0; i < corners; ++i) {
      const double angle = 2.0 * std::numbers::pi * (i + draw(-0.3, 0.3)) / corners;
      region.polygon.emplace_back(wide * std::cos(angle), high * std::sin(angle));
    }
  } else if (kind % 4 == 1) {
    const double x = draw(50, w - 50), y = draw(50, h - 50);
    for (const auto& [px, py] : {std::pair{0.0, 0.0}, {w, 0.0}, {w, y}, {x, y}, {x, h}, {0.0, h}})
      region.polygon.emplace_back(1e-3 * px, 1e-3 * py);
  } else if (kind % 4 == 2) {
    region.polygon = box_mm(0, 0, w, h);
    region.islands = {box_mm(draw(35, 50), draw(35, 45), draw(55, 70), draw(50, 80))};
    if (draw(0, 1) < 0.5) {
      const double x = draw(95, w - 20), y = draw(20, h - 40);
      region.islands.push_back(
          {1e-3 * Eigen::Vector2d(x, y), 1e-3 * Eigen::Vector2d(x + 15, y + 5), 1e-3 * Eigen::Vector2d(x + 5, y + 30)});
    }
  } else {
    const double floor = draw(30, 50), wall = draw(w / 3 - 5, w / 3 + 5), next = wall + draw(8, 20);
    for (const auto& [px, py] :
         {std::pair{0.0, 0.0}, {w, 0.0}, {w, h}, {next, h}, {next, floor}, {wall, floor}, {wall, h}, {0.0, h}})
      region.polygon.emplace_back(1e-3 * px, 1e-3 * py);
  }
  if (draw(0, 1) < 0.5) std::reverse(region.polygon.begin(), region.polygon.end());
  return turned(std::move(region), draw(0, 2.0 * std::numbers::pi));
}

inline double distance_to_line(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& point) {
  const Eigen::Vector2d way = b - a;
  const double squared = way.squaredNorm();
  const double part = squared > 0.0 ? std::clamp((point - a).dot(way) / squared, 0.0, 1.0) : 0.0;
  return (a + part * way - point).norm();
}

template <typename Each>
void for_each_edge(const Region& region, Each each) {
  const auto edges = [&](const Contour& contour, bool island) {
    for (std::size_t i = 0; i < contour.size(); ++i) each(contour[i], contour[(i + 1) % contour.size()], island);
  };
  edges(region.polygon, false);
  for (const Contour& island : region.islands) edges(island, true);
}

inline bool machined(const Region& region, const Eigen::Vector2d& point) {
  bool inside = false;
  for_each_edge(region, [&](const auto& a, const auto& b, bool) {
    if ((a.y() > point.y()) != (b.y() > point.y()) &&
        point.x() < a.x() + (b.x() - a.x()) * (point.y() - a.y()) / (b.y() - a.y()))
      inside = !inside;
  });
  return inside;
}

// From a point to the nearest edge; with `overhang` to the nearest of an island.
inline double distance_to_edges(const Region& region, const Eigen::Vector2d& point, bool overhang = false) {
  double least = std::numeric_limits<double>::infinity();
  for_each_edge(region, [&](const auto& a, const auto& b, bool island) {
    if (island || !overhang) least = std::min(least, distance_to_line(a, b, point));
  });
  return least;
}

inline double distance_to_cuts(const ToolPath& path, const Eigen::Vector2d& point) {
  double least = std::numeric_limits<double>::infinity();
  for (const PathMove& move : path.moves)
    if (move.cutting) least = std::min(least, distance_to_line(move.from.head<2>(), move.to.head<2>(), point));
  return least;
}

inline double cutting_length(const ToolPath& path) {
  double length = 0.0;
  for (const PathMove& move : path.moves)
    if (move.cutting) length += (move.to - move.from).norm();
  return length;
}

inline Eigen::Vector2d random_point(std::mt19937& random, const Region& region) {
  Eigen::Vector2d low = region.polygon.front(), high = low;
  for (const auto& point : region.polygon) {
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  }
  std::uniform_real_distribution<double> share(0.0, 1.0);
  return {std::lerp(low.x(), high.x(), share(random)), std::lerp(low.y(), high.y(), share(random))};
}

}  // namespace stillcut::test
