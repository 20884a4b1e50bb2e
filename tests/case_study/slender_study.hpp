// The limits of the slender tool by the paper's projection, position by position and radial depth by radial depth.
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "tests/case_study/plate_study.hpp"

namespace stillcut::case_study {

inline constexpr std::array<double, 3> kRadialShares{0.25, 0.5, 0.75};  // of the tool's diameter

struct SlenderFigures {
  std::vector<double> best_deg;  // one a position: highest absolute limit from 0 to 90 degrees
  std::vector<double> best_mm;   // that limit
};
// The cell's cut at a radial depth, at every posture of the map.
SlenderFigures slender_figures(const Cell& cell, const DynamicsMap& map, double radial_share, int speeds, int jobs,
                               const std::function<void(double)>& progress);

// What one position allows in every direction, 18 degrees apart as the paper's figure 6b, at each speed.
struct CommonLobes {
  double absolute_mm = 0.0;                // lowest over speeds and directions
  double depth_mm = 0.0, speed_rpm = 0.0;  // the speed at which all directions go deepest
};
CommonLobes common_lobes(const Cell& cell, std::span<const Mode> modes, int speeds);

}  // namespace stillcut::case_study
