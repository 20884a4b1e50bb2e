// Surfaces whose roughness is known in closed form.
#pragma once

#include <cmath>
#include <numbers>
#include <random>

#include "models/height_map.hpp"

namespace stillcut {

// heights(x, y) at every point; x along the feed, y across it, m.
template <class Heights>
HeightMap surface_of(std::size_t along, std::size_t across, double spacing_along, double spacing_across,
                     Heights heights) {
  HeightMap map{along, across, spacing_along, spacing_across, std::vector<double>(along * across)};
  for (std::size_t j = 0; j < across; ++j)
    for (std::size_t i = 0; i < along; ++i)
      map.at(i, j) = heights(static_cast<double>(i) * spacing_along, static_cast<double>(j) * spacing_across);
  return map;
}

// Parabolas side by side, their cusps `height` above their bottoms: what a ball end leaves.
inline double scallop(double y, double step, double height) {
  const double u = 2.0 * (y / step - std::floor(y / step)) - 1.0;
  return height * u * u;
}

inline HeightMap noise_map(std::size_t along, std::size_t across, double rms, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal(0.0, rms);
  return surface_of(along, across, 4e-6, 5e-6, [&](double, double) { return normal(random); });
}

}  // namespace stillcut
