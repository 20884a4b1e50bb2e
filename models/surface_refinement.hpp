// How fine the grid of a swept surface must be: it is halved until the roughness stops moving, and what is left of the
// error is estimated.
#pragma once

#include <functional>

#include "models/surface_sweep.hpp"

namespace stillcut {

// Arithmetic mean deviation of the heights from their least-squares plane (S_a of ISO 25178-2, unfiltered), m. Points
// not cut count as little as if they were not there; NaN without three points.
[[nodiscard]] double arithmetic_deviation(const HeightMap& map);

// Runs task(0) to task(count - 1), in any order, on as many threads as it likes.
using Workers = std::function<void(std::size_t count, const std::function<void(std::size_t)>& task)>;

struct RefinementSetup {
  double along = 0.0, across = 0.0;  // m
  double spacing = 0.0;              // m, of the first grid; 0: the coarsest allowed
  bool allow_coarse = false;         // of the first grids: a coarser one is cheap, and tells how much a finer one gains
  double tolerance = 0.01;           // of the roughness, relative
  std::size_t most_points = 25'000'000;
  std::function<double(const HeightMap&)> figure = arithmetic_deviation;
  Workers workers{};  // empty: the calling thread alone
};

struct RefinedSurface {
  HeightMap map;
  double figure = 0.0;  // of the map
  double error = 0.0;   // estimated, of the figure, relative; infinite where there was no finer grid to compare with
  bool converged = false;
};

// Sweeps the surface on grids each twice as fine as the one before, until the estimate is within the tolerance or a
// finer grid would have too many points. The estimate takes the error to fall with the first power of the spacing: then
// what is left is as large as the last change, which is on the safe side, as smooth parts fall with the second.
// Throws std::invalid_argument as SurfaceSweep does.
[[nodiscard]] RefinedSurface refined_surface(const CutterMotion& motion, const Cut& cut,
                                             std::span<const CutterPass> passes, const RefinementSetup& setup);

// All tiles of a map of these spacings, by all workers.
SweepCount sweep_all(const SurfaceSweep& sweep, HeightMap& map, std::span<const CutterPass> passes,
                     const Workers& workers = {});

}  // namespace stillcut
