// The stiffness of each area that lets its cut leave the roughness that was measured there.
#pragma once

#include <array>
#include <functional>
#include <span>

#include "tests/surface_study/area_map.hpp"
#include "tests/surface_study/area_surface.hpp"

namespace stillcut::surface_study {

// What is the same everywhere, chosen by hand (docs/surface-case-study.md says how).
struct StudySettings {
  AreaModes modes{.frequency_hz = 64.0, .damping_ratio = 0.03};
  double noise = 0.02;  // rms of the force, the default of `stillcut simulate`
};

// As case_study_surface_fit finds them, N/m.
inline constexpr std::array<double, kAreas> kFittedStiffness{0.60e6, 0.60e6, 0.60e6, 0.60e6, 0.60e6, 0.60e6};

// How far R_a and R_q together are off, logarithm of the ratio to what was measured.
[[nodiscard]] double misfit(const AreaFigures& figures, const PublishedArea& area);

struct FitPoint {
  double stiffness = 0.0;  // N/m
  double misfit = 0.0;     // as above; infinite where the cut ran away
};

// Roughness falls with stiffness, with some scatter: where the parabola through the points, in logarithms, goes through
// zero, or comes nearest to it between the first and the last point.
[[nodiscard]] double fitted_stiffness(std::span<const FitPoint> points);

// The area's cut on modes of these stiffnesses.
[[nodiscard]] std::vector<FitPoint> fit_points(std::size_t area, std::span<const double> stiffness,
                                               const StudySettings& settings, int jobs,
                                               const std::function<void(const FitPoint&, const AreaFigures&)>& done);

// Leaving each area out in turn: what the map of the other five says of its surface. Another seed than the fit's: what
// noise does to a cut is not known beforehand.
[[nodiscard]] AreaSurface left_out_surface(std::size_t area, const std::array<double, kAreas>& stiffness,
                                           const StudySettings& settings, int jobs);

}  // namespace stillcut::surface_study
