// Which feed direction to choose at each location: the best by the limit at any speed, those nearly as good, outliers
// brought back among their neighbours, and locations gathered into groups that one direction serves (feed-direction
// paper, sections 5.2 and 6.1.1); or, for all locations at once, the directions that leave the deepest pocket in
// common.
#pragma once

#include <vector>

#include "models/direction_table.hpp"

namespace stillcut {

struct ChosenDirection {
  double best = 0.0;       // rad: highest a_abs; of equal ones the first
  double chosen = 0.0;     // rad: the same, or one nearly as good that fits the neighbours
  bool outlier = false;    // best lies outside the range of the neighbours' best
  std::vector<bool> near;  // one a direction of the table: a_abs within the tolerance of the best
  std::size_t group = 0;   // which of DirectionField::groups it is in
};

// Locations that hang together and that one direction serves within the tolerance.
struct DirectionGroup {
  double direction = 0.0;  // rad
  std::vector<std::size_t> locations;
};

struct DirectionField {
  std::vector<ChosenDirection> locations;
  std::vector<DirectionGroup> groups;  // the largest first
};

// `tolerance`: how much less than the best still counts as nearly as good, 0.1 in the paper. Neighbours are locations
// within 1.5 times the reach (models/places.hpp), so that on a grid the diagonal ones are. Throws
// std::invalid_argument for a tolerance outside 0 to 1.
DirectionField direction_field(const DirectionTable& table, double tolerance = 0.1);

// The global choice: the speed at which the worst location, each in its own best direction there, allows the deepest
// cut, and those directions; where several directions allow it, the one nearest to the local choice.
struct GlobalChoice {
  Pocket common;
  std::vector<double> directions;  // rad, one a location
};
GlobalChoice global_choice(const DirectionTable& table, const DirectionField& field);

// What the local choice leaves in common: the deepest pocket along every location's chosen direction.
Pocket common_pocket(const DirectionTable& table, const std::vector<double>& directions);

}  // namespace stillcut
