// Table 1 made of limits over the feed direction at every point of the plate, whoever computed them.
#pragma once

#include <span>
#include <vector>

#include "tests/case_study/published.hpp"

namespace stillcut::case_study {

// Limits (m) of one point: [direction][speed].
using PointLimits = std::vector<std::vector<double>>;

struct PlateLimits {
  std::vector<double> directions_deg;  // 0 and 90 among them
  std::vector<double> speeds;          // rad/s
  std::vector<PointLimits> points;     // in the order of plate_points()
};

struct PlateFigures {
  Table1 table;
  std::vector<double> zig_asi_percent;  // one a direction
  double best_zig_deg = 0.0;            // the highest of them
  std::vector<double> best_deg;         // one a point
  double absolute_gain = 0.0;           // lowest limit of ZIG0 over that of ZIG90
  double mean_gain = 0.0;               // the same of the index
  struct CommonPocket {
    double depth_mm = 0.0, speed_rpm = 0.0;  // deepest that is stable at every point at one speed
  };
  std::vector<CommonPocket> pockets;                    // one a direction
  std::array<CommonPocket, kPatterns> pattern_pockets;  // each pattern in its local directions
  double pocket_gain = 0.0;                             // ZIG0 over ZIG90
};

PlateFigures plate_figures(const PlateLimits& limits);

}  // namespace stillcut::case_study
