#include "models/wall_profile.hpp"

#include <algorithm>
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

Roughness roughness(std::span<const double> heights, double spacing) {
  if (heights.size() < 3 || !(spacing > 0.0))
    throw std::invalid_argument("roughness needs a spacing and at least three points");
  const auto count = static_cast<double>(heights.size());
  const double middle = 0.5 * (count - 1.0);
  double mean = 0.0, moment = 0.0, spread = 0.0;
  for (const double height : heights) mean += height / count;
  for (std::size_t i = 0; i < heights.size(); ++i) {
    const double x = static_cast<double>(i) - middle;
    moment += x * (heights[i] - mean);
    spread += x * x;
  }
  const double rise = moment / spread;
  Roughness result{.mean = mean, .slope = rise / spacing};
  double lowest = 0.0, highest = 0.0, squares = 0.0;
  for (std::size_t i = 0; i < heights.size(); ++i) {
    const double height = heights[i] - mean - rise * (static_cast<double>(i) - middle);
    result.ra += std::abs(height) / count;
    squares += height * height;
    lowest = std::min(lowest, height);
    highest = std::max(highest, height);
  }
  result.rq = std::sqrt(squares / count);
  result.rt = highest - lowest;
  return result;
}

}  // namespace stillcut
