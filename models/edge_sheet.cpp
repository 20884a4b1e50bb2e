#include "models/edge_sheet.hpp"

#include <cmath>

namespace stillcut {
namespace {

Eigen::Vector3d in_tool_axes(const EdgePoint& point) {
  return {-point.radius * std::sin(point.lag), point.radius * std::cos(point.lag), point.height};
}

}  // namespace

std::vector<SheetSag> sheet_sag(std::span<const EdgePoint> points, double turn, double runout) {
  std::vector<SheetSag> sag(knot_count(points.size()) - 1);
  for (std::size_t k = 0; k < sag.size(); ++k) {
    const std::size_t from = knot_point(k, points.size()), to = knot_point(k + 1, points.size());
    const Eigen::Vector3d a = in_tool_axes(points[from]), b = in_tool_axes(points[to]);
    double radius = 0.0;
    for (std::size_t i = from; i <= to; ++i) {
      const double share = static_cast<double>(i - from) / static_cast<double>(to - from);
      const Eigen::Vector3d off = in_tool_axes(points[i]) - a - share * (b - a);
      sag[k].across = std::max(sag[k].across, off.head<2>().norm());
      sag[k].along = std::max(sag[k].along, std::abs(off.z()));
      radius = std::max(radius, points[i].radius);
    }
    sag[k].across += (radius + runout) * (1.0 - std::cos(0.5 * std::min(turn, kTwoPi)));
  }
  return sag;
}

}  // namespace stillcut
