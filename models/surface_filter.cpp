#include "models/surface_filter.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "dsp/numbers.hpp"
#include "models/surface_profiles.hpp"

namespace stillcut {
namespace {

constexpr double kLeastPoints = 5.0;  // a cutoff: the bell is summed, not integrated

// Of the points 0, 1, ... away; not yet summing to 1.
std::vector<double> bell(std::size_t count, double spacing, double cutoff) {
  if (!(cutoff >= kLeastPoints * spacing * (1.0 - 1e-9)))
    throw std::invalid_argument("the cutoff must be at least five points long; choose a longer one");
  if (!(cutoff <= spacing * static_cast<double>(count) * (1.0 + 1e-9)))
    throw std::invalid_argument("the cutoff must not be longer than the surface; choose a shorter one");
  const auto reach = std::min(count - 1, static_cast<std::size_t>(cutoff / spacing));
  const double alpha = std::sqrt(std::numbers::ln2 / std::numbers::pi);
  std::vector<double> weights(reach + 1);
  for (std::size_t k = 0; k <= reach; ++k) {
    const double share = static_cast<double>(k) * spacing / (alpha * cutoff);
    weights[k] = std::exp(-std::numbers::pi * share * share);
  }
  return weights;
}

// What is summed under the bell: heights that are known, and how much of the bell lies over such.
struct Weighed {
  std::vector<double> heights, weight;
};

Weighed known_of(std::span<const double> heights) {
  Weighed known{{heights.begin(), heights.end()}, std::vector<double>(heights.size(), 1.0)};
  for (std::size_t k = 0; k < heights.size(); ++k)
    if (std::isnan(heights[k])) known.heights[k] = known.weight[k] = 0.0;
  return known;
}

// Sums under the bell over a grid of `count` steps, each of `width` values side by side: those of one row, to go along
// the rows of a map at once.
std::vector<double> summed(const std::vector<double>& values, std::size_t count, std::size_t width,
                           const std::vector<double>& weights) {
  std::vector<double> sums(values.size(), 0.0);
  const std::size_t reach = weights.size() - 1;
  for (std::size_t to = 0; to < count; ++to) {
    double* sum = &sums[to * width];
    for (std::size_t from = to - std::min(to, reach); from <= std::min(to + reach, count - 1); ++from) {
      const double weight = weights[from > to ? from - to : to - from];
      const double* value = &values[from * width];
      for (std::size_t k = 0; k < width; ++k) sum[k] += weight * value[k];
    }
  }
  return sums;
}

std::vector<double> transposed(const std::vector<double>& values, std::size_t rows, std::size_t columns) {
  std::vector<double> result(values.size());
  for (std::size_t r = 0; r < rows; ++r)
    for (std::size_t c = 0; c < columns; ++c) result[c * rows + r] = values[r * columns + c];
  return result;
}

std::vector<double> mean_under_bell(std::span<const double> heights, const Weighed& sums) {
  std::vector<double> means(heights.size(), kNaN);
  for (std::size_t k = 0; k < heights.size(); ++k)
    if (!std::isnan(heights[k])) means[k] = sums.heights[k] / sums.weight[k];
  return means;
}

}  // namespace

std::vector<double> waviness(std::span<const double> profile, double spacing, double cutoff) {
  if (profile.empty()) throw std::invalid_argument("a profile needs points");
  const std::vector<double> weights = bell(profile.size(), spacing, cutoff);
  const Weighed known = known_of(profile);
  return mean_under_bell(
      profile, {summed(known.heights, profile.size(), 1, weights), summed(known.weight, profile.size(), 1, weights)});
}

HeightMap waviness(const HeightMap& map, double cutoff) {
  require_sound_map(map);
  const std::vector<double> along = bell(map.along, map.spacing_along, cutoff);
  const std::vector<double> across = bell(map.across, map.spacing_across, cutoff);
  const auto over_both = [&](const std::vector<double>& values) {
    const std::vector<double> once = summed(values, map.across, map.along, across);
    const std::vector<double> twice = summed(transposed(once, map.across, map.along), map.along, map.across, along);
    return transposed(twice, map.along, map.across);
  };
  const Weighed known = known_of(map.heights);
  HeightMap result = map;
  result.heights = mean_under_bell(map.heights, {over_both(known.heights), over_both(known.weight)});
  return result;
}

}  // namespace stillcut
