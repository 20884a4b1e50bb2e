// Looks for the depth at which a cut turns unstable at one speed: a scan that brackets it, and the root in the bracket.
#pragma once

#include <optional>

#include "models/floquet.hpp"

namespace stillcut {

struct DepthBracket {
  double low = 0.0, high = 0.0;  // m; stable at low, unstable at high
  bool found = false;
};

struct DepthScan {
  DepthBracket crossing;
  double peak = 0.0;             // largest radius seen below the crossing
  bool always_unstable = false;  // down to a billionth of the largest depth
};

// Throws std::invalid_argument unless the largest depth of a search (m) is positive and finite.
void check_max_depth(double max_depth);

// From a 500th of the largest depth (m) up, in steps of 15 %, with a closer look at peaks of the radius just below 1.
DepthScan scan_depths(CutAtSpeed& cutting, double max_depth);

struct DepthCrossing {
  double depth = 0.0;  // m
  double slope = 0.0;  // of log radius over depth, 1/m
};

// The depth in the bracket where log(radius) is 0, by the Illinois form of false position, to a relative tolerance.
// Nothing when the bracket does not hold at this resolution.
std::optional<DepthCrossing> crossing_in(CutAtSpeed& cutting, const DepthBracket& bracket, double tolerance);

}  // namespace stillcut
