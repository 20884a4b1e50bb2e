#include "models/surface_profiles.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace stillcut {

std::size_t profile_count(const HeightMap& map, ProfileDirection direction) {
  return direction == ProfileDirection::along ? map.across : map.along;
}

double profile_spacing(const HeightMap& map, ProfileDirection direction) {
  return direction == ProfileDirection::along ? map.spacing_along : map.spacing_across;
}

std::vector<double> surface_profile(const HeightMap& map, ProfileDirection direction, std::size_t index) {
  const bool along = direction == ProfileDirection::along;
  std::vector<double> heights(along ? map.along : map.across);
  for (std::size_t k = 0; k < heights.size(); ++k) heights[k] = along ? map.at(k, index) : map.at(index, k);
  return heights;
}

void require_sound_map(const HeightMap& map) {
  const auto positive = [](double spacing) { return spacing > 0.0 && std::isfinite(spacing); };
  if (map.along == 0 || map.across == 0) throw std::invalid_argument("a height map needs points");
  if (!positive(map.spacing_along) || !positive(map.spacing_across))
    throw std::invalid_argument("a height map needs the spacing of its points");
  if (map.heights.size() / map.along != map.across || map.heights.size() % map.along != 0)
    throw std::invalid_argument("a height map needs one height a point");
  if (std::any_of(map.heights.begin(), map.heights.end(), [](double h) { return std::isinf(h); }))
    throw std::invalid_argument("a height of the map is infinite");
}

std::size_t known_points(const std::vector<double>& heights) {
  return static_cast<std::size_t>(
      std::count_if(heights.begin(), heights.end(), [](double height) { return !std::isnan(height); }));
}

}  // namespace stillcut
