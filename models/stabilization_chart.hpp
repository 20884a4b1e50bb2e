// Which poles of fits of rising order stay where they are: physical modes do, poles of noise wander.
#pragma once

#include <vector>

namespace stillcut {

enum class PoleMethod { lscf, polynomials };  // models/pole_fractions

struct ChartPole {
  double natural_frequency = 0.0;  // rad/s
  double damping_ratio = 0.0;
  // Beside the nearest pole of the order below: within 1 % in frequency, 5 % in damping, and its shape within 2 %.
  bool stable_frequency = false, stable_damping = false, stable_shape = false;

  [[nodiscard]] bool stable() const { return stable_frequency && stable_damping && stable_shape; }
};

struct ChartRow {
  int order = 0;  // pairs of poles fitted in each part of the band
  std::vector<ChartPole> poles;
};

struct StabilizationChart {
  std::vector<ChartRow> rows;  // rising order
};

// Frequencies, where a chart's poles agree over the orders: rising, each with the median damping.
[[nodiscard]] std::vector<ChartPole> agreed_poles(const StabilizationChart& chart);

}  // namespace stillcut
