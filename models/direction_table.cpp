#include "models/direction_table.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "dsp/numbers.hpp"

namespace stillcut {
namespace {

constexpr double kSameDirection = 1e-9;  // rad

}  // namespace

double axis_of(double direction) {
  constexpr double kHalfTurn = std::numbers::pi;
  const double axis = direction - kHalfTurn * std::floor(direction / kHalfTurn);
  return axis > kHalfTurn - kSameDirection ? 0.0 : axis;
}

double axis_angle(double a, double b) { return std::abs(std::remainder(a - b, std::numbers::pi)); }

const DirectionCurve& curve_at(std::span<const DirectionCurve> curves, double direction) {
  const auto found = std::find_if(curves.begin(), curves.end(), [&](const DirectionCurve& curve) {
    return axis_angle(curve.direction, direction) < kSameDirection;
  });
  if (found == curves.end()) throw std::invalid_argument("limits over direction: this direction was not computed");
  return *found;
}

double bounded_absolute_limit(const DirectionCurve& curve, double max_depth) {
  return std::min(absolute_limit(curve.limits), max_depth);
}

double bounded_pocket_depth(const DirectionCurve& curve, double max_depth) {
  return std::min(*std::max_element(curve.limits.begin(), curve.limits.end()), max_depth);
}

double best_absolute_limit(const DirectionTable& table, const LocationLimits& location) {
  double best = 0.0;
  for (const double direction : table.directions)
    best = std::max(best, bounded_absolute_limit(curve_at(location.curves, direction), table.max_depth));
  return best;
}

double best_pocket_depth(const DirectionTable& table, const LocationLimits& location) {
  double best = 0.0;
  for (const double direction : table.directions)
    best = std::max(best, bounded_pocket_depth(curve_at(location.curves, direction), table.max_depth));
  return best;
}

double stability_ratio(const DirectionTable& table, const LocationLimits& location, const DirectionCurve& curve) {
  const double best = best_absolute_limit(table, location);
  return best > 0.0 ? std::min(bounded_absolute_limit(curve, table.max_depth) / best, 1.0) : kNaN;
}

std::vector<double> common_limits(std::span<const DirectionCurve* const> curves, double max_depth) {
  if (curves.empty()) return {};
  std::vector<double> common(curves.front()->limits.size(), max_depth);
  for (const DirectionCurve* curve : curves) {
    std::transform(common.begin(), common.end(), curve->limits.begin(), common.begin(),
                   [](double so_far, double limit) { return std::min(so_far, limit); });
  }
  return common;
}

}  // namespace stillcut
