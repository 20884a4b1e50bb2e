// The stiffness of each area that lets its cut leave the roughness that was measured there.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "tests/surface_study/area_map.hpp"
#include "tests/surface_study/area_surface.hpp"

namespace stillcut::surface_study {

// What is the same everywhere, chosen by hand (docs/surface-case-study.md says how).
struct StudySettings {
  AreaModes modes{.frequency_hz = 64.0, .damping_ratio = 0.05};
  double noise = 0.6;  // rms of the force
};

// As surface_study_fit finds them, N/m, A to F.
inline constexpr std::array<double, kAreas> kFittedStiffness{1.0862e6, 0.9074e6, 0.8790e6,
                                                             1.2347e6, 0.9384e6, 1.0138e6};

// What a surface is expected to be: the mean over cuts whose force varies otherwise, as nobody knows it beforehand.
[[nodiscard]] AreaFigures expected_figures(int of_case, const std::vector<Mode>& modes, double noise,
                                           std::span<const std::uint64_t> seeds, int jobs);

struct FitPoint {
  double stiffness = 0.0;  // N/m
  AreaFigures figures;
};

// Where R_a and R_q together are as measured: on a parabola through the points, in logarithms, between the first and
// the last of them. Throws std::invalid_argument for fewer than three points.
[[nodiscard]] double fitted_stiffness(std::span<const FitPoint> points, const PublishedArea& area);

// What the map of the other five says of the surface of an area that it has not.
[[nodiscard]] AreaFigures left_out_figures(std::size_t area, const std::array<double, kAreas>& stiffness,
                                           const StudySettings& settings, std::span<const std::uint64_t> seeds,
                                           int jobs);

}  // namespace stillcut::surface_study
