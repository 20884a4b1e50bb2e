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

// The sums under both bells of a map's values, in their place: blocks of columns, then of rows turned to columns, so
// that a large map needs no second one.
void sum_over_both(std::vector<double>& values, std::size_t along, std::size_t across,
                   const std::vector<double>& bell_along, const std::vector<double>& bell_across) {
  constexpr std::size_t kBlock = 64;
  const auto sum = [&](std::size_t count, std::size_t lines, const std::vector<double>& weights, auto at) {
    for (std::size_t begin = 0; begin < lines; begin += kBlock) {
      const std::size_t width = std::min(kBlock, lines - begin);
      std::vector<double> block(count * width);
      for (std::size_t k = 0; k < count; ++k)
        for (std::size_t l = 0; l < width; ++l) block[k * width + l] = values[at(k, begin + l)];
      const std::vector<double> sums = summed(block, count, width, weights);
      for (std::size_t k = 0; k < count; ++k)
        for (std::size_t l = 0; l < width; ++l) values[at(k, begin + l)] = sums[k * width + l];
    }
  };
  sum(across, along, bell_across, [along](std::size_t j, std::size_t i) { return j * along + i; });
  sum(along, across, bell_along, [along](std::size_t i, std::size_t j) { return j * along + i; });
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
  HeightMap result = map;
  std::replace_if(
      result.heights.begin(), result.heights.end(), [](double height) { return std::isnan(height); }, 0.0);
  sum_over_both(result.heights, map.along, map.across, along, across);
  if (known_points(map.heights) == map.heights.size()) {  // the weight is that along times that across
    const std::vector<double> weight_along = summed(std::vector<double>(map.along, 1.0), map.along, 1, along);
    const std::vector<double> weight_across = summed(std::vector<double>(map.across, 1.0), map.across, 1, across);
    for (std::size_t j = 0; j < map.across; ++j)
      for (std::size_t i = 0; i < map.along; ++i) result.at(i, j) /= weight_along[i] * weight_across[j];
    return result;
  }
  std::vector<double> weight(map.heights.size());
  std::transform(map.heights.begin(), map.heights.end(), weight.begin(),
                 [](double height) { return std::isnan(height) ? 0.0 : 1.0; });
  sum_over_both(weight, map.along, map.across, along, across);
  for (std::size_t k = 0; k < weight.size(); ++k)
    result.heights[k] = std::isnan(map.heights[k]) ? kNaN : result.heights[k] / weight[k];
  return result;
}

}  // namespace stillcut
