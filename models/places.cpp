#include "models/places.hpp"

#include <algorithm>
#include <limits>
#include <vector>

namespace stillcut {

double reach_of(std::span<const Eigen::Vector2d> places) {
  if (places.size() < 2) return std::numeric_limits<double>::infinity();
  // Prim's algorithm: from one place on, always the nearest one that is not joined yet.
  std::vector<double> distance(places.size(), std::numeric_limits<double>::infinity());
  std::vector<bool> joined(places.size(), false);
  double longest = 0.0;
  for (std::size_t joined_last = 0, count = 1; count < places.size(); ++count) {
    joined[joined_last] = true;
    std::size_t nearest = places.size();
    for (std::size_t i = 0; i < places.size(); ++i) {
      if (joined[i]) continue;
      distance[i] = std::min(distance[i], (places[i] - places[joined_last]).norm());
      if (nearest == places.size() || distance[i] < distance[nearest]) nearest = i;
    }
    longest = std::max(longest, distance[nearest]);
    joined_last = nearest;
  }
  return longest;
}

std::size_t nearest_place(const Eigen::Vector2d& point, std::span<const Eigen::Vector2d> places) {
  const auto nearest =
      std::min_element(places.begin(), places.end(), [&](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
        return (a - point).squaredNorm() < (b - point).squaredNorm();
      });
  return static_cast<std::size_t>(nearest - places.begin());
}

}  // namespace stillcut
