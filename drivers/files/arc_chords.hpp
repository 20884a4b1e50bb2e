// Arcs and helices in the XY plane as G2 and G3 program them, and the chords they are broken into.
#pragma once

#include <Eigen/Core>
#include <cstddef>

namespace stillcut {

inline constexpr double kChordSagitta = 10e-6;  // m, the most that a chord lies beside its arc
inline constexpr double kMostChords = 1e6;      // of one arc
inline constexpr double kSameArcPoint = 1e-8;   // m: an arc that ends where it began is a full circle

struct PathArc {
  Eigen::Vector3d from, to;
  Eigen::Vector2d centre;
  double sweep = 0.0;  // rad, anti-clockwise positive, seen from +Z
};

// Both throw std::invalid_argument with what is wrong and what to do. The radii at both ends may differ by what
// rounding to 1 µm explains (5 µm, or 0.1 % of the radius up to 0.1 mm); the arc then goes evenly from one to the
// other.
PathArc arc_about(const Eigen::Vector3d& from, const Eigen::Vector3d& to, const Eigen::Vector2d& centre,
                  bool clockwise);
// The shorter arc; of a negative radius, the longer one.
PathArc arc_of_radius(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double radius, bool clockwise);

// As many as keep within the sagitta. Throws std::invalid_argument above a million.
std::size_t chord_count(const PathArc& arc);
// The arc's point at a share of its way: 0 is `from`, 1 is `to`.
Eigen::Vector3d point_on_arc(const PathArc& arc, double share);

}  // namespace stillcut
