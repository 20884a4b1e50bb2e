// The stabilization chart of measured frequency responses.
#pragma once

#include "models/frf_lines.hpp"
#include "models/stabilization_chart.hpp"

namespace stillcut {

// A robot's modes lie over two and a half decades, which one denominator does not resolve: the band is cut into octaves
// from the top, each fitted with a margin on both sides, and gives the poles that lie in the octave itself.
[[nodiscard]] StabilizationChart chart_of(const FrfLines& lines, const FrfWeights& weights, int most_pairs,
                                          PoleMethod method);

}  // namespace stillcut
