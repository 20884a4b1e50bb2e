// Which poles of fits of rising order stay where they are: physical modes do, poles of noise wander.
#pragma once

#include <vector>

namespace stillcut {

struct ChartPole {
  double natural_frequency = 0.0;  // rad/s
  double damping_ratio = 0.0;
  // Beside the nearest pole of the order below: within 1 % in frequency, 5 % in damping, and its shape within 2 %.
  bool stable_frequency = false, stable_damping = false, stable_shape = false;
};

struct ChartRow {
  int order = 0;  // pairs of poles that were fitted
  std::vector<ChartPole> poles;
};

struct StabilizationChart {
  std::vector<ChartRow> rows;  // rising order
};

}  // namespace stillcut
