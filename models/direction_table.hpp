// The limits over feed direction at every location of a machining area: what ranking of patterns, choice of directions
// and the plan of a path all read (feed-direction paper, section 5.2: the area divided into points).
#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "models/direction_limits.hpp"

namespace stillcut {

// The limits at one location. A direction and its opposite are one: directions are in [0, pi).
struct LocationLimits {
  std::string posture;
  Eigen::Vector2d place = Eigen::Vector2d::Zero();  // m, workpiece XY
  std::vector<DirectionCurve> curves;               // milling as it is set
  std::vector<DirectionCurve> alternating;          // the lower of down and up; empty: not asked for
};

struct DirectionTable {
  std::vector<double> directions;  // rad, rising, in [0, pi): those that every location has
  std::vector<double> speeds;      // rad/s
  double max_depth = 0.0;          // m; a limit beyond it counts as this
  std::vector<LocationLimits> locations;
};

// The direction without its sense: in [0, pi), and what is pi but for rounding is 0.
double axis_of(double direction);

// The angle between two axes, in [0, pi/2].
double axis_angle(double a, double b);

// The curve of a direction or its opposite. Throws std::invalid_argument where it was not computed.
const DirectionCurve& curve_at(std::span<const DirectionCurve> curves, double direction);

// Limits as depths that can be averaged and compared: at most `max_depth`.
double bounded_absolute_limit(const DirectionCurve& curve, double max_depth);  // a_abs, m
double bounded_pocket_depth(const DirectionCurve& curve, double max_depth);    // a_pocket, m

// The highest a_abs and a_pocket over the table's directions at a location, m.
double best_absolute_limit(const DirectionTable& table, const LocationLimits& location);
double best_pocket_depth(const DirectionTable& table, const LocationLimits& location);

// a_abs of a curve over that of the best of the table's directions, at most 1; NaN where none is stable at all speeds.
double stability_ratio(const DirectionTable& table, const LocationLimits& location, const DirectionCurve& curve);

// What holds at all these curves at once: at every speed the lowest limit, at most `max_depth`.
std::vector<double> common_limits(std::span<const DirectionCurve* const> curves, double max_depth);

}  // namespace stillcut
