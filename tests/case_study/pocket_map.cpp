#include "tests/case_study/pocket_map.hpp"

#include <cmath>

#include "models/machining.hpp"
#include "tests/case_study/plate.hpp"

namespace stillcut::case_study {

const std::array<ParameterRange, kPocketParameters> kPocketRanges{{{"k, N/m", 2e5, 1.5e6},
                                                                   {"a", -0.6, 0.6},
                                                                   {"b", -0.6, 0.6},
                                                                   {"c", -0.4, 0.4},
                                                                   {"d", -0.4, 0.4},
                                                                   {"r", 0.8, 3.0},
                                                                   {"s", -0.3, 0.3},
                                                                   {"q", 1.035, 1.08},
                                                                   {"g, Hz", -12.0, 12.0},
                                                                   {"z_x", 0.035, 0.06},
                                                                   {"z_y", 0.01, 0.03}}};

// Seed 1 of case_study_fit search, to four digits.
const PocketParameters kFittedPocket{5.072e5, -0.09456, -0.3283, -0.03382, -0.1668, 2.328,
                                     0.0696,  1.047,    -3.399,  0.05514,  0.02116};

std::vector<Mode> pocket_modes(const PocketParameters& parameters, double u, double v) {
  const auto [k, a, b, c, d, r, s, q, g, damping_x, damping_y] = parameters;
  const double k_x = k * std::exp(a * u + b * v + c * u * u + d * v * v);
  constexpr double kTool_hz = 490.0, kStructure = 8.0, kStructureDamping = 0.04;
  return {{kTwoPi * (55.0 + 5.0 * u), kStructureDamping, kStructure * k_x, {1, 0, 0}},
          {kTwoPi * (125.0 + 5.0 * v), kStructureDamping, kStructure * k_x, {0, 1, 0}},
          {kTwoPi * (kTool_hz / std::sqrt(q) + g * u), damping_x, k_x, {1, 0, 0}},
          {kTwoPi * kTool_hz * std::sqrt(q), damping_y, k_x * r * std::exp(s * u), {0, 1, 0}}};
}

DynamicsMap pocket_map(const PocketParameters& parameters) {
  DynamicsMap map;
  for (const PlatePoint& point : plate_points()) {
    Posture posture;
    posture.id = point.id;
    posture.position = {point.x, point.y, 0.0};
    posture.modes = pocket_modes(parameters, point.u, point.v);
    sort_modes(posture.modes);
    map.postures.push_back(posture);
  }
  return map;
}

}  // namespace stillcut::case_study
