#include "models/surface_roughness.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <stdexcept>
#include <vector>

#include "dsp/numbers.hpp"
#include "models/surface_filter.hpp"

namespace stillcut {
namespace {

constexpr std::size_t kSamplingLengths = 5, kPointsForThem = 25;

double largest_distance(std::span<const double> heights) {
  double largest = 0.0;
  for (const double height : heights) largest = std::max(largest, std::abs(height));  // false for NaN
  return largest;
}

// What is left of a flat surface less its form is rounding, which has no shape.
void forget_shape_of_rounding(HeightStatistics& statistics, double largest_height) {
  if (statistics.rms <= 16.0 * std::numeric_limits<double>::epsilon() * largest_height)
    statistics.skewness = statistics.kurtosis = kNaN;
}

// Mean over sampling lengths of the highest peak above the deepest valley.
double mean_of_total_heights(std::span<const double> heights, double spacing, double cutoff) {
  std::size_t length = heights.size() < kPointsForThem ? heights.size() : heights.size() / kSamplingLengths;
  if (cutoff > 0.0) length = std::min(heights.size(), static_cast<std::size_t>(std::lround(cutoff / spacing)));
  double sum = 0.0;
  std::size_t lengths = 0;
  for (std::size_t begin = 0; begin + length <= heights.size(); begin += length) {
    const HeightStatistics part = height_statistics(heights.subspan(begin, length));
    if (part.known == 0) continue;
    sum += part.highest - part.lowest;
    ++lengths;
  }
  return sum / static_cast<double>(lengths);
}

}  // namespace

HeightStatistics height_statistics(std::span<const double> heights) {
  HeightStatistics result{.lowest = kInfinity, .highest = -kInfinity};
  double distances = 0.0, squares = 0.0;
  for (const double height : heights) {
    if (std::isnan(height)) continue;
    ++result.known;
    distances += std::abs(height);
    squares += height * height;
    result.lowest = std::min(result.lowest, height);
    result.highest = std::max(result.highest, height);
  }
  if (result.known == 0) return {.lowest = kNaN, .highest = kNaN, .skewness = kNaN, .kurtosis = kNaN};
  const auto count = static_cast<double>(result.known);
  result.mean_distance = distances / count;
  result.rms = std::sqrt(squares / count);
  double thirds = 0.0, fourths = 0.0;
  for (const double height : heights) {
    if (std::isnan(height)) continue;
    const double share = height / result.rms;
    thirds += share * share * share;
    fourths += share * share * share * share;
  }
  result.skewness = result.rms > 0.0 ? thirds / count : kNaN;
  result.kurtosis = result.rms > 0.0 ? fourths / count : kNaN;
  return result;
}

ProfileRoughness profile_roughness(std::span<const double> heights, double spacing, const RoughnessSettings& settings) {
  if (!(spacing > 0.0)) throw std::invalid_argument("roughness needs the spacing of the profile's points");
  std::vector<double> profile(heights.begin(), heights.end());
  const std::size_t known = known_points(profile);
  if (!known_enough(known, profile.size()))
    throw std::invalid_argument("less than half of the profile is known; its roughness is open");
  remove_form(profile, settings.form);
  if (settings.cutoff != 0.0) {
    const std::vector<double> waves = waviness(profile, spacing, settings.cutoff);
    std::transform(profile.begin(), profile.end(), waves.begin(), profile.begin(), std::minus<>());
  }
  HeightStatistics statistics = height_statistics(profile);
  forget_shape_of_rounding(statistics, largest_distance(heights));
  return {.ra = statistics.mean_distance,
          .rq = statistics.rms,
          .rt = statistics.highest - statistics.lowest,
          .rz = mean_of_total_heights(profile, spacing, settings.cutoff),
          .rsk = statistics.skewness,
          .rku = statistics.kurtosis,
          .unknown = profile.size() - known};
}

ProfileRoughness mean_of(std::span<const ProfileRoughness> profiles) {
  ProfileRoughness mean;
  for (const auto figure : {&ProfileRoughness::ra, &ProfileRoughness::rq, &ProfileRoughness::rt, &ProfileRoughness::rz,
                            &ProfileRoughness::rsk, &ProfileRoughness::rku}) {
    double sum = 0.0;
    std::size_t count = 0;
    for (const ProfileRoughness& profile : profiles) {
      if (std::isnan(profile.*figure)) continue;
      sum += profile.*figure;
      ++count;
    }
    mean.*figure = count > 0 ? sum / static_cast<double>(count) : kNaN;
  }
  for (const ProfileRoughness& profile : profiles) mean.unknown += profile.unknown;
  return mean;
}

MeanRoughness mean_roughness(const HeightMap& map, ProfileDirection direction, const RoughnessSettings& settings) {
  require_sound_map(map);
  const double spacing = profile_spacing(map, direction);
  MeanRoughness result;
  std::vector<ProfileRoughness> profiles;
  std::size_t unknown = 0;
  for (std::size_t p = 0; p < profile_count(map, direction); ++p) {
    const std::vector<double> heights = surface_profile(map, direction, p);
    const std::size_t known = known_points(heights);
    unknown += heights.size() - known;
    if (!known_enough(known, heights.size())) {
      ++result.left_out;
      continue;
    }
    profiles.push_back(profile_roughness(heights, spacing, settings));
  }
  if (profiles.empty())
    throw std::invalid_argument("less than half of every profile is known; the roughness of the surface is open");
  result.mean = mean_of(profiles);
  result.mean.unknown = unknown;  // those left out too
  result.profiles = profiles.size();
  return result;
}

ArealRoughness areal_roughness(const HeightMap& map, const RoughnessSettings& settings) {
  require_sound_map(map);
  const std::size_t known = known_points(map.heights);
  if (!known_enough(known, map.heights.size()))
    throw std::invalid_argument("less than half of the surface is known; its roughness is open");
  HeightMap rough = map;
  remove_form(rough, settings.form);
  if (settings.cutoff != 0.0) {
    const HeightMap waves = waviness(rough, settings.cutoff);
    std::transform(rough.heights.begin(), rough.heights.end(), waves.heights.begin(), rough.heights.begin(),
                   std::minus<>());
  }
  HeightStatistics statistics = height_statistics(rough.heights);
  forget_shape_of_rounding(statistics, largest_distance(map.heights));
  return {.sa = statistics.mean_distance,
          .sq = statistics.rms,
          .sz = statistics.highest - statistics.lowest,
          .ssk = statistics.skewness,
          .sku = statistics.kurtosis,
          .unknown = map.heights.size() - known};
}

}  // namespace stillcut
