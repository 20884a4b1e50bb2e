#include "models/wall_profile.hpp"

#include <cmath>
#include <stdexcept>

namespace stillcut {

std::vector<double> wall_profile(const PartSlice& slice, const WallLine& line) {
  if (!(line.spacing > 0.0 && line.reach > 0.0 && line.length >= 2.0 * line.spacing))
    throw std::invalid_argument("a wall profile needs a spacing, a reach and at least three points");
  const auto points = static_cast<std::size_t>(std::floor(line.length / line.spacing * (1.0 + 1e-12))) + 1;
  std::vector<double> heights;
  heights.reserve(points);
  for (std::size_t i = 0; i < points; ++i) {
    const Eigen::Vector2d from = line.start + static_cast<double>(i) * line.spacing * line.along;
    heights.push_back(slice.free_way(from, from + line.reach * line.into));
    if (!std::isfinite(heights.back())) throw std::runtime_error("the wall profile has a place without a wall");
  }
  return heights;
}

}  // namespace stillcut
