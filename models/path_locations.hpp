// Which way a tool path feeds at each location of a machining area. The locations stand for all that is nearer to them
// than to any other (feed-direction paper, section 5.2: the area covered by the path, discretized into points).
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "models/tool_path.hpp"

namespace stillcut {

struct LocalCut {
  std::size_t location = 0;
  double direction = 0.0;    // rad, in [0, pi)
  double share = 1.0;        // of what is cut at the location: 1 where it is all in one direction
  bool alternating = false;  // along it, both down and up
};

struct PathOnLocations {
  std::vector<LocalCut> cuts;  // of the locations that the path comes to, in their order; the shares of each sum to 1
  double cutting_length = 0.0, air_length = 0.0;  // m, in all
  double farthest = 0.0;                          // m, of a cutting place from its location
  Eigen::Vector2d farthest_place{0.0, 0.0};       // m
};

// Directions within `same_direction` (rad) of one in which much is cut are taken as that one, as with the chords of an
// arc; what makes up less than a tenth of the cutting at a location, as links from pass to pass do, is left out. Moves
// across the plane count; plunges and what a path calls slotting, its links, do not. Throws std::invalid_argument
// without locations.
PathOnLocations path_on_locations(const ToolPath& path, std::span<const Eigen::Vector2d> places,
                                  double same_direction = 0.0873);

}  // namespace stillcut
