// The surface of one area, 2 x 2 mm, swept on a grid as fine as the paper's own bound and put on its 100 x 100 points.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "models/dynamics_map.hpp"
#include "models/height_map.hpp"
#include "models/machining.hpp"

namespace stillcut::surface_study {

struct AreaFigures {
  double ra = 0.0, rq = 0.0;              // m, mean over the profiles across the feed
  double ra_along = 0.0, rq_along = 0.0;  // m
  double sa = 0.0, sq = 0.0;              // m
  double interval_along = 0.0;            // m, of the strongest line of the texture; NaN: nothing repeats
  double width_along = 0.0;               // m, mean width of a hill and a valley (R_Sm)
  double peak = 0.0;                      // m, of the vibration; 0: none
};

struct AreaSurface {
  HeightMap map;  // 100 x 100
  AreaFigures figures;
};

// Without modes: without vibration. `noise`: rms variation of the cutting force. Throws std::runtime_error where the
// cut runs away.
[[nodiscard]] AreaSurface area_surface(const Cut& cut, const std::vector<Mode>& modes, double noise, std::uint64_t seed,
                                       int jobs);

}  // namespace stillcut::surface_study
