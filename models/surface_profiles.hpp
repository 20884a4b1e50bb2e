// The profiles of a height map, as a stylus would draw them: along the feed or across it.
#pragma once

#include <cstddef>
#include <vector>

#include "models/height_map.hpp"

namespace stillcut {

enum class ProfileDirection { across, along };  // the feed

[[nodiscard]] std::size_t profile_count(const HeightMap& map, ProfileDirection direction);
[[nodiscard]] double profile_spacing(const HeightMap& map, ProfileDirection direction);  // m, of a profile's points
[[nodiscard]] std::vector<double> surface_profile(const HeightMap& map, ProfileDirection direction, std::size_t index);

// Throws std::invalid_argument for a map without points, of a spacing that is not positive, of more or fewer heights
// than its grid has, or with a height that is infinite.
void require_sound_map(const HeightMap& map);

// Points whose height is known.
[[nodiscard]] std::size_t known_points(const std::vector<double>& heights);

// Whether a profile or map is known well enough for a figure of its roughness: half of its points.
[[nodiscard]] inline bool known_enough(std::size_t known, std::size_t points) {
  return known > 0 && 2 * known >= points;
}

}  // namespace stillcut
