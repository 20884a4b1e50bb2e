#include "models/path_locations.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "models/direction_table.hpp"

namespace stillcut {
namespace {

// Cutting in one direction at one location.
struct Stretch {
  double direction = 0.0;
  double length = 0.0;
  bool down = false, up = false;
};

void add_to(std::vector<Stretch>& stretches, double direction, double length, std::optional<Milling> milling) {
  constexpr double kSame = 1e-6;  // rad
  auto found = std::find_if(stretches.begin(), stretches.end(),
                            [&](const Stretch& known) { return axis_angle(known.direction, direction) < kSame; });
  if (found == stretches.end()) found = stretches.insert(found, Stretch{direction});
  found->length += length;
  found->down = found->down || milling == Milling::down;
  found->up = found->up || milling == Milling::up;
}

// The direction around which most is cut: of chords of an arc none is long, but their neighbours count with them.
LocalCut longest(const std::vector<Stretch>& stretches, std::size_t location, double same_direction) {
  LocalCut best{location};
  double best_length = -1.0;
  for (const Stretch& middle : stretches) {
    double length = 0.0;
    bool down = false, up = false;
    for (const Stretch& other : stretches) {
      if (axis_angle(other.direction, middle.direction) > same_direction) continue;
      length += other.length;
      down = down || other.down;
      up = up || other.up;
    }
    constexpr double kNoLonger = 1.0 + 1e-9;  // lengths that differ by rounding only: the first one stays
    if (length > best_length * kNoLonger) {
      best_length = length;
      best.direction = middle.direction;
      best.alternating = down && up;
    }
  }
  return best;
}

}  // namespace

double reach_of(std::span<const Eigen::Vector2d> places) {
  double reach = 0.0;
  for (const Eigen::Vector2d& place : places) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const Eigen::Vector2d& other : places) {
      const double distance = (other - place).norm();
      if (distance > 0.0) nearest = std::min(nearest, distance);
    }
    reach = std::max(reach, nearest);
  }
  return reach;
}

std::size_t nearest_location(const Eigen::Vector2d& place, std::span<const Eigen::Vector2d> places) {
  const auto nearest =
      std::min_element(places.begin(), places.end(), [&](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
        return (a - place).squaredNorm() < (b - place).squaredNorm();
      });
  return static_cast<std::size_t>(nearest - places.begin());
}

PathOnLocations path_on_locations(const ToolPath& path, std::span<const Eigen::Vector2d> places,
                                  double same_direction) {
  if (places.empty()) throw std::invalid_argument("tool path: there are no locations to judge it at");
  constexpr double kPiecesOfReach = 20.0, kLongestPiece = 5e-3;  // m
  const double piece = std::min(reach_of(places) / kPiecesOfReach, kLongestPiece);
  PathOnLocations result;
  std::vector<std::vector<Stretch>> stretches(places.size());
  for (const PathMove& move : path.moves) {
    const Eigen::Vector2d from = move.from.head<2>(), way = move.to.head<2>() - from;
    const double length = (move.to - move.from).norm();
    (move.cutting ? result.cutting_length : result.air_length) += length;
    if (!move.cutting || way.norm() < 1e-9) continue;
    const double direction = axis_of(std::atan2(way.y(), way.x()));
    const int pieces = std::max(1, static_cast<int>(std::ceil(way.norm() / piece)));
    for (int i = 0; i < pieces; ++i) {
      const Eigen::Vector2d place = from + way * ((i + 0.5) / pieces);
      const std::size_t location = nearest_location(place, places);
      add_to(stretches[location], direction, length / pieces, move.milling);
      const double distance = (places[location] - place).norm();
      if (distance > result.farthest) result.farthest = distance, result.farthest_place = place;
    }
  }
  for (std::size_t i = 0; i < places.size(); ++i)
    if (!stretches[i].empty()) result.cuts.push_back(longest(stretches[i], i, same_direction));
  return result;
}

}  // namespace stillcut
