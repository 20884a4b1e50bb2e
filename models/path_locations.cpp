#include "models/path_locations.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "models/direction_table.hpp"
#include "models/places.hpp"

namespace stillcut {
namespace {

// Cutting in one direction at one location.
struct Stretch {
  double direction = 0.0;
  double length = 0.0;
  bool down = false, up = false;
};

void add_to(std::vector<Stretch>& stretches, double direction, double length, std::optional<Milling> milling) {
  // Arcs have as many directions as chords; closer together than this they are kept as one.
  constexpr double kSame = 5e-3;  // rad
  auto found = std::find_if(stretches.begin(), stretches.end(),
                            [&](const Stretch& known) { return axis_angle(known.direction, direction) < kSame; });
  if (found == stretches.end()) found = stretches.insert(found, Stretch{direction});
  found->length += length;
  found->down = found->down || milling == Milling::down;
  found->up = found->up || milling == Milling::up;
}

// Cutting within `same_direction` of a stretch's own direction.
Stretch gathered_around(const Stretch& middle, const std::vector<Stretch>& stretches, double same_direction) {
  Stretch sum{middle.direction};
  for (const Stretch& other : stretches) {
    if (axis_angle(other.direction, middle.direction) > same_direction) continue;
    sum.length += other.length;
    sum.down = sum.down || other.down;
    sum.up = sum.up || other.up;
  }
  return sum;
}

// The direction around which most is cut, what is left, and so on. Of directions in which as much is cut, but for
// rounding, the lowest angle, so that a path and the same path backwards are told alike.
void add_cuts(std::vector<Stretch> stretches, std::size_t location, double same_direction,
              std::vector<LocalCut>& cuts) {
  constexpr double kLeastShare = 0.1, kLonger = 1.0 + 1e-6;
  double all = 0.0, kept = 0.0;
  for (const Stretch& stretch : stretches) all += stretch.length;
  std::sort(stretches.begin(), stretches.end(),
            [](const Stretch& a, const Stretch& b) { return a.direction < b.direction; });
  const auto first = static_cast<std::ptrdiff_t>(cuts.size());
  while (!stretches.empty()) {
    Stretch most;
    for (const Stretch& stretch : stretches) {
      const Stretch sum = gathered_around(stretch, stretches, same_direction);
      if (sum.length > kLonger * most.length) most = sum;
    }
    if (most.length < kLeastShare * all) break;
    cuts.push_back({location, most.direction, most.length, most.down && most.up});
    kept += most.length;
    std::erase_if(stretches, [&](const Stretch& stretch) {
      return axis_angle(stretch.direction, most.direction) <= same_direction;
    });
  }
  std::for_each(cuts.begin() + first, cuts.end(), [&](LocalCut& cut) { cut.share /= kept; });
}

}  // namespace

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
    const bool link = move.milling == Milling::slot;  // from pass to pass
    if (!move.cutting || link || way.norm() < 1e-9) continue;
    const double direction = axis_of(std::atan2(way.y(), way.x()));
    const int pieces = std::max(1, static_cast<int>(std::ceil(way.norm() / piece)));
    for (int i = 0; i < pieces; ++i) {
      const Eigen::Vector2d place = from + way * ((i + 0.5) / pieces);
      const std::size_t location = nearest_place(place, places);
      add_to(stretches[location], direction, length / pieces, move.milling);
      const double distance = (places[location] - place).norm();
      if (distance > result.farthest) result.farthest = distance, result.farthest_place = place;
    }
  }
  for (std::size_t i = 0; i < places.size(); ++i)
    if (!stretches[i].empty()) add_cuts(std::move(stretches[i]), i, same_direction, result.cuts);
  return result;
}

}  // namespace stillcut
