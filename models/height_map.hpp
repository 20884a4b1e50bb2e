// Heights over a grid of a machined surface: what the simulated cutter leaves, what an instrument measured, what
// roughness is computed of.
#pragma once

#include <cstddef>
#include <vector>

namespace stillcut {

// Point (i, j) lies i * spacing_along along the feed and j * spacing_across across it from the first one. NaN where
// nothing is known: not cut, not measured.
struct HeightMap {
  std::size_t along = 0, across = 0;                 // points
  double spacing_along = 0.0, spacing_across = 0.0;  // m
  std::vector<double> heights;                       // m, upward; [j * along + i]

  [[nodiscard]] double& at(std::size_t i, std::size_t j) { return heights[j * along + i]; }
  [[nodiscard]] double at(std::size_t i, std::size_t j) const { return heights[j * along + i]; }
};

}  // namespace stillcut
