#include "models/region.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <stdexcept>

namespace stillcut {
namespace {

// Points are compared on a grid of 10 nm: on it the sense of turning of three points no farther than 10 m from the
// origin is exact in 64 bits.
constexpr double kRegionGrain = 1e-8;     // m
constexpr double kFarthestPoint = 10.0;   // m
constexpr double kLeastRegionArea = 1e3;  // grains^2, as of a square of 0.3 um

struct RegionPoint {
  std::int64_t x = 0, y = 0;
  bool operator==(const RegionPoint&) const = default;
};

struct RegionEdge {
  RegionPoint from, to;
  std::size_t contour = 0, index = 0, last = 0;  // which edge of which contour, and the number of that contour's last
};

struct Meeting {
  RegionEdge a, b;
  Eigen::Vector2d at;  // m
};

RegionPoint on_grid(const Eigen::Vector2d& point) {
  return {std::llround(point.x() / kRegionGrain), std::llround(point.y() / kRegionGrain)};
}

Eigen::Vector2d in_metres(const RegionPoint& point) {
  return kRegionGrain * Eigen::Vector2d(static_cast<double>(point.x), static_cast<double>(point.y));
}

int turning(const RegionPoint& a, const RegionPoint& b, const RegionPoint& c) {
  const std::int64_t left = (b.x - a.x) * (c.y - a.y), right = (b.y - a.y) * (c.x - a.x);
  return left > right ? 1 : left < right ? -1 : 0;
}

bool within_box(const RegionEdge& edge, const RegionPoint& point) {
  return std::min(edge.from.x, edge.to.x) <= point.x && point.x <= std::max(edge.from.x, edge.to.x) &&
         std::min(edge.from.y, edge.to.y) <= point.y && point.y <= std::max(edge.from.y, edge.to.y);
}

bool on_edge(const RegionEdge& edge, const RegionPoint& point) {
  return within_box(edge, point) && turning(edge.from, edge.to, point) == 0;
}

// Where two edges meet: at an end that lies on the other edge, or where they cross.
std::optional<Eigen::Vector2d> meeting_point(const RegionEdge& a, const RegionEdge& b) {
  for (const RegionPoint& point : {b.from, b.to})
    if (on_edge(a, point)) return in_metres(point);
  for (const RegionPoint& point : {a.from, a.to})
    if (on_edge(b, point)) return in_metres(point);
  if (turning(a.from, a.to, b.from) * turning(a.from, a.to, b.to) >= 0) return std::nullopt;
  if (turning(b.from, b.to, a.from) * turning(b.from, b.to, a.to) >= 0) return std::nullopt;
  const Eigen::Vector2d begin = in_metres(a.from), way = in_metres(a.to) - begin;
  const Eigen::Vector2d other = in_metres(b.from), other_way = in_metres(b.to) - other;
  const auto cross = [](const Eigen::Vector2d& u, const Eigen::Vector2d& v) { return u.x() * v.y() - u.y() * v.x(); };
  return begin + way * (cross(other - begin, other_way) / cross(way, other_way));
}

// Edges that follow each other share a point; they meet elsewhere only where the contour folds back on itself.
std::optional<Eigen::Vector2d> fold(const RegionEdge& edge, const RegionEdge& next) {
  if (on_edge(edge, next.to)) return in_metres(next.to);
  if (on_edge(next, edge.from)) return in_metres(edge.from);
  return std::nullopt;
}

std::optional<Eigen::Vector2d> fault_point(const RegionEdge& a, const RegionEdge& b) {
  const auto follows = [](const RegionEdge& next, const RegionEdge& edge) {
    return next.contour == edge.contour && next.index == (edge.index == edge.last ? 0 : edge.index + 1);
  };
  if (follows(b, a)) return fold(a, b);
  if (follows(a, b)) return fold(b, a);
  return meeting_point(a, b);
}

void add_edges(std::vector<RegionEdge>& edges, const Contour& contour, std::size_t number) {
  std::vector<RegionPoint> points;
  for (const Eigen::Vector2d& point : without_repeats(contour)) points.push_back(on_grid(point));
  for (std::size_t i = 0; i < points.size(); ++i)
    edges.push_back({points[i], points[(i + 1) % points.size()], number, i, points.size() - 1});
}

std::optional<Meeting> first_meeting(std::vector<RegionEdge> edges) {
  const auto left = [](const RegionEdge& edge) { return std::min(edge.from.x, edge.to.x); };
  std::sort(edges.begin(), edges.end(), [&](const auto& a, const auto& b) { return left(a) < left(b); });
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const std::int64_t right = std::max(edges[i].from.x, edges[i].to.x);
    for (std::size_t k = i + 1; k < edges.size() && left(edges[k]) <= right; ++k)
      if (const auto at = fault_point(edges[i], edges[k])) return Meeting{edges[i], edges[k], *at};
  }
  return std::nullopt;
}

// Of a point that lies on no edge.
bool encloses(const Contour& contour, const Eigen::Vector2d& point) {
  bool inside = false;
  Eigen::Vector2d a = contour.back();
  for (const Eigen::Vector2d& b : contour) {
    if ((a.y() > point.y()) != (b.y() > point.y()) &&
        point.x() < a.x() + (b.x() - a.x()) * (point.y() - a.y()) / (b.y() - a.y()))
      inside = !inside;
    a = b;
  }
  return inside;
}

std::string island_name(std::size_t index) { return "island " + std::to_string(index + 1); }

// `name` is "the polygon" or an island's. Crossings are left to first_meeting.
std::optional<std::string> contour_fault(const Contour& contour, const std::string& name) {
  for (const Eigen::Vector2d& point : contour) {
    if (!point.allFinite()) return name + " has a point that is no number; correct its points";
    if (point.cwiseAbs().maxCoeff() > kFarthestPoint)
      return name + " has a point at " + in_mm(point) + ", more than 10 m from the origin; correct its points";
  }
  const Contour points = without_repeats(contour);
  if (points.size() < 3)
    return name + " has " + std::to_string(points.size()) + " different points; give at least three";
  double twice = 0.0;
  for (std::size_t i = 1; i + 1 < points.size(); ++i) {
    const Eigen::Vector2d a = points[i] - points[0], b = points[i + 1] - points[0];
    twice += a.x() * b.y() - a.y() * b.x();
  }
  std::vector<RegionEdge> edges;
  add_edges(edges, points, 0);
  const bool straight = std::all_of(edges.begin(), edges.end(),
                                    [&](const auto& e) { return turning(e.from, e.to, edges.front().from) == 0; });
  const auto meeting = first_meeting(edges);
  if (meeting && !straight)
    return name + " crosses or touches itself at " + in_mm(meeting->at) + "; correct its points";
  if (straight || !(std::abs(twice) > kLeastRegionArea * kRegionGrain * kRegionGrain))
    return name + " encloses no area; correct its points";
  return std::nullopt;
}

}  // namespace

std::string in_mm(const Eigen::Vector2d& point) {
  char text[80];
  const Eigen::Vector2d mm = 1e3 * point + Eigen::Vector2d::Zero();  // no minus before a zero
  std::snprintf(text, sizeof text, "(%.7g, %.7g) mm", mm.x(), mm.y());
  return text;
}

Contour without_repeats(const Contour& contour) {
  Contour points;
  for (const Eigen::Vector2d& point : contour)
    if (points.empty() || on_grid(points.back()) != on_grid(point)) points.push_back(point);
  while (points.size() > 1 && on_grid(points.back()) == on_grid(points.front())) points.pop_back();
  return points;
}

std::optional<std::string> polygon_fault(const Contour& polygon) { return contour_fault(polygon, "the polygon"); }

std::optional<std::string> islands_fault(const Region& region) {
  std::vector<RegionEdge> edges;
  add_edges(edges, region.polygon, region.islands.size());
  for (std::size_t i = 0; i < region.islands.size(); ++i) {
    if (auto fault = contour_fault(region.islands[i], island_name(i))) return fault;
    add_edges(edges, region.islands[i], i);
  }
  if (const auto meeting = first_meeting(edges)) {
    const auto [low, high] = std::minmax(meeting->a.contour, meeting->b.contour);
    const bool polygon = high == region.islands.size();
    return island_name(low) + " meets " + (polygon ? "the polygon" : island_name(high)) + " at " + in_mm(meeting->at) +
           (polygon ? "; move it inside, or make it part of the polygon" : "; make one island of the two");
  }
  const auto& islands = region.islands;
  for (std::size_t i = 0; i < islands.size(); ++i)
    if (const Eigen::Vector2d& point = islands[i].front(); !encloses(region.polygon, point))
      return island_name(i) + " lies outside the polygon, at " + in_mm(point) + "; move it inside or leave it out";
  for (std::size_t i = 0; i < islands.size(); ++i)
    for (std::size_t k = 0; k < islands.size(); ++k)
      if (const Eigen::Vector2d& point = islands[i].front(); k != i && encloses(islands[k], point))
        return island_name(i) + " lies within " + island_name(k) + ", at " + in_mm(point) + "; leave it out";
  return std::nullopt;
}

Region checked_region(const Region& region) {
  if (const auto fault = polygon_fault(region.polygon)) throw std::invalid_argument(*fault);
  if (const auto fault = islands_fault(region)) throw std::invalid_argument(*fault);
  Region result{without_repeats(region.polygon), {}};
  for (const Contour& island : region.islands) result.islands.push_back(without_repeats(island));
  return result;
}

}  // namespace stillcut
