// The pictures of `stillcut fit`.
#pragma once

#include "tools/fit_study.hpp"
#include "tools/plot.hpp"

namespace stillcut {

// One posture's responses, magnitude and phase, measured and fitted, up to three entries, direct ones first; under them
// the stabilization chart.
plot::Figure response_figure(const FitStudy& study, std::size_t posture);

// MAC between all modes found at all postures, ordered by track: a track is a bright square.
plot::Figure assurance_figure(const FitStudy& study);

// Natural frequency of the tracks: over the plane in which the postures spread most where their places are known and
// spread in two directions; otherwise from posture to posture. The `trend` interpolation colours what lies between.
plot::Figure track_figure(const FitStudy& study);

}  // namespace stillcut
