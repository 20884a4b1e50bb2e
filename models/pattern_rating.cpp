#include "models/pattern_rating.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "dsp/numbers.hpp"

namespace stillcut {
namespace {

double mean_of(double sum, double weight) { return weight > 0.0 ? sum / weight : kNaN; }

}  // namespace

double feed_rate_at(const CuttingConditions& conditions, double spindle_speed) {
  return conditions.feed_per_tooth * conditions.teeth * spindle_speed / kTwoPi;
}

std::vector<const DirectionCurve*> curves_along(const DirectionTable& table, std::span<const LocalCut> cuts) {
  std::vector<const DirectionCurve*> curves;
  curves.reserve(cuts.size());
  for (const LocalCut& cut : cuts) {
    const LocationLimits& location = table.locations[cut.location];
    curves.push_back(&curve_at(cut.alternating ? location.alternating : location.curves, cut.direction));
  }
  return curves;
}

PatternRating rate_path(const DirectionTable& table, const PathOnLocations& path, const CuttingConditions& conditions) {
  if (path.cuts.empty()) throw std::invalid_argument("tool path: it cuts nowhere in the plane");
  const std::vector<const DirectionCurve*> curves = curves_along(table, path.cuts);
  PatternRating rating;
  rating.min_absolute = kInfinity;
  double ratios = 0.0, pocket_ratios = 0.0;
  double rated = 0.0, pockets_rated = 0.0;
  for (std::size_t i = 0; i < curves.size(); ++i) {
    const LocationLimits& location = table.locations[path.cuts[i].location];
    const double share = path.cuts[i].share;
    const double limit = bounded_absolute_limit(*curves[i], table.max_depth);
    rating.min_absolute = std::min(rating.min_absolute, limit);
    rating.max_absolute = std::max(rating.max_absolute, limit);
    const double ratio = stability_ratio(table, location, *curves[i]);
    if (!std::isnan(ratio)) ratios += share * ratio, rated += share;
    const double best_pocket = best_pocket_depth(table, location);
    if (best_pocket > 0.0) {
      pocket_ratios += share * std::min(bounded_pocket_depth(*curves[i], table.max_depth) / best_pocket, 1.0);
      pockets_rated += share;
    }
  }
  rating.asi = mean_of(ratios, rated);
  rating.msi = mean_of(pocket_ratios, pockets_rated);
  rating.common = deepest_pocket(common_limits(curves, table.max_depth), table.speeds);
  const double feed_rate = feed_rate_at(conditions, rating.common.speed);
  rating.removal_rate = rating.common.depth * conditions.radial_depth * feed_rate;
  const double time = path.cutting_length / feed_rate + path.air_length / conditions.rapid_rate;
  rating.time_per_depth = rating.common.depth > 0.0 ? time / rating.common.depth : kInfinity;
  return rating;
}

}  // namespace stillcut
