#include "tests/case_study/slender_map.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <string>

#include "dsp/numbers.hpp"
#include "models/machining.hpp"
#include "models/paper_projection.hpp"
#include "models/receptance.hpp"

namespace stillcut::case_study {
namespace {

constexpr int kColumns = 5, kRows = 6;
constexpr double kToolFrom_hz = 400.0, kToolTo_hz = 600.0;

std::vector<Mode> slender_modes(const SlenderParameters& p, double s, double t) {
  constexpr double kTool_hz = 500.0, kStructureDamping = 0.04;
  const double ratio = 2.0 * std::pow(1.5, t) * std::exp(-p.h * s);
  return {{kTwoPi * (50.0 + 10.0 * s), kStructureDamping, p.structure * p.k_y, {1, 0, 0}},
          {kTwoPi * (120.0 + 8.0 * t), kStructureDamping, p.structure * p.k_y, {0, 1, 0}},
          {kTwoPi * kTool_hz / std::sqrt(p.q), p.z_x, p.k_y * p.z_y / (p.z_x * ratio), {1, 0, 0}},
          {kTwoPi * kTool_hz * std::sqrt(p.q), p.z_y, p.k_y, {0, 1, 0}}};
}

template <class Response>
double tool_peak(std::span<const Mode> modes, const Response& response) {
  double peak = 0.0;
  for (double hz = kToolFrom_hz; hz < kToolTo_hz; hz += 0.25)
    peak = std::max(peak, std::abs(response(receptance(modes, kTwoPi * hz))));
  return peak;
}

}  // namespace

DynamicsMap slender_map(const SlenderParameters& parameters) {
  DynamicsMap map;
  for (int row = 0; row < kRows; ++row) {
    for (int column = 0; column < kColumns; ++column) {
      Posture posture;
      posture.id = std::to_string(map.postures.size() + 1);
      posture.position = {0.3 * column / (kColumns - 1), 0.3 * row / (kRows - 1), 0.0};
      posture.modes = slender_modes(parameters, static_cast<double>(column) / (kColumns - 1), row / 4.0);
      sort_modes(posture.modes);
      map.postures.push_back(posture);
    }
  }
  return map;
}

double peak_ratio(std::span<const Mode> modes) {
  return tool_peak(modes, [](const Eigen::Matrix3cd& g) { return g(0, 0); }) /
         tool_peak(modes, [](const Eigen::Matrix3cd& g) { return g(1, 1); });
}

double least_peak_deg(std::span<const Mode> modes) {
  double least = kInfinity, at = 0.0;
  for (int degrees = 0; degrees <= 90; degrees += 5) {
    const double peak =
        tool_peak(modes, [&](const Eigen::Matrix3cd& g) { return paper_projection(g, deg_to_rad(degrees)).feed; });
    if (peak < least) least = peak, at = degrees;
  }
  return at;
}

}  // namespace stillcut::case_study
