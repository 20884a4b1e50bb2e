// Which redundancy angle and which placement of the part allow the deepest cut, of the variations that `stillcut
// directions` computed, and how that is told. What lies outside the map is never chosen.
#pragma once

#include <iosfwd>
#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "tools/direction_study.hpp"

namespace stillcut {

// The highest and the lowest absolute limit over the directions, m.
double best_limit(const PostureDirections& posture);
double worst_limit(const PostureDirections& posture);

// What every asked posture takes at a placement, each in its best direction and at its best redundancy angle.
struct PlacementLimit {
  double x = 0.0, y = 0.0;  // m
  double limit = 0.0;       // m; NaN: at some posture the robot cannot stand so, or the map does not know it
  std::size_t weakest = 0;  // the asked posture that allows the least
};

// In the order of the placements asked, along X first.
std::vector<PlacementLimit> placement_limits(const DirectionsResult& result);

// The one with the highest limit, of equal ones the nearest to where the part is; null where none is known.
const PlacementLimit* best_placement(const std::vector<PlacementLimit>& placements);

// The asked posture at a placement with the redundancy angle of the highest limit, of equal ones the angle nearest to
// 0; null where none is inside the map.
const PostureDirections* best_at(const DirectionsResult& result, std::size_t task, double x, double y);

// That very combination; null where it was not asked, or the robot cannot stand so.
const PostureDirections* variation_at(const DirectionsResult& result, std::size_t task, const Variation& variation);

// {"best": …, "best_worst_direction": …, "best_placement": …}: the combination with the highest limit over all its
// directions, the one whose worst direction is best, and the placement; null where none is inside the map.
nlohmann::ordered_json choice_json(const DirectionsResult& result);

// The best placement, where one was asked, and a line a posture: its best redundancy angle and what it gains.
void print_choice(const DirectionsResult& result, std::ostream& out);

// The limits over the redundancy angle (or over a placement along one axis), a line a posture, and over a placement
// along both as a coloured grid.
plot::Figure variations_figure(const DirectionsResult& result, double own_direction);

}  // namespace stillcut
