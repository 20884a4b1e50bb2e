// How good a tool path is for the dynamics under it: the indices of the feed-direction paper (section 5.2, eq. 6), the
// pocket that all its locations have in common, and what metal that lets be cut.
#pragma once

#include "models/direction_table.hpp"
#include "models/machining.hpp"
#include "models/path_locations.hpp"

namespace stillcut {

struct PatternRating {
  double asi = 0.0;  // mean over the locations, and there over what is cut, of a_abs along the path over that of the
                     // best direction; NaN: none stable
  double msi = 0.0;  // the same of the deepest pockets
  double min_absolute = 0.0, max_absolute = 0.0;  // m, of a_abs along the path
  Pocket common;                                  // deepest depth stable at all locations at one speed
  double removal_rate = 0.0;                      // m^3/s, at the common pocket
  double time_per_depth = 0.0;                    // s/m: cutting and moving, a metre of depth, at the common pocket
};

struct CuttingConditions {
  int teeth = 0;
  double feed_per_tooth = 0.0;  // m
  double radial_depth = 0.0;    // m
  double rapid_rate = 0.2;      // m/s
};

double feed_rate_at(const CuttingConditions& conditions, double spindle_speed);  // m/s

// The curves that hold along the path, one a cut. Throws std::invalid_argument for a direction that was not computed.
std::vector<const DirectionCurve*> curves_along(const DirectionTable& table, std::span<const LocalCut> cuts);

// Throws std::invalid_argument for a path that cuts nowhere.
PatternRating rate_path(const DirectionTable& table, const PathOnLocations& path, const CuttingConditions& conditions);

}  // namespace stillcut
