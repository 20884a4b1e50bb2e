// The plate of the case study: a pocket of 300 x 300 mm, looked at in 7 x 7 points that are 50 mm apart.
#pragma once

#include <string>
#include <vector>

namespace stillcut::case_study {

inline constexpr int kPointsASide = 7;
inline constexpr double kSide = 0.3;  // m

struct PlatePoint {
  std::string id;              // "1" to "49", along x first
  double x = 0.0, y = 0.0;     // m, from the pocket's corner
  double u = 0.0, v = 0.0;     // the same from -1 to 1 across the pocket
  double periphery_deg = 0.0;  // feed along the nearest side, without its sense
};

// Follow periphery feeds along the side that is nearest: 0 at the bottom and the top, 90 at the left and the right.
// Equally near two sides, on a diagonal, a point belongs to the side that begins in its corner as one goes round
// counter-clockwise; the centre to the bottom. So 25 points feed along 0 and 24 along 90.
std::vector<PlatePoint> plate_points();

inline constexpr int kCentre = kPointsASide * kPointsASide / 2;  // index of the plate's middle

}  // namespace stillcut::case_study
