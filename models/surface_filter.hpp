// The Gaussian filter that parts waviness from roughness (ISO 16610-21 for profiles, ISO 16610-61 for surfaces): it
// leaves half of a wave as long as the cutoff λ_c in the waviness, more of a longer one.
#pragma once

#include <span>
#include <vector>

#include "models/height_map.hpp"

namespace stillcut {

// Weights s(x) = exp(-π (x/(α λ_c))²)/(α λ_c), α = √(ln 2/π), cut off at |x| = λ_c where they are below a millionth. At
// the ends and beside heights that are NaN, the weights that are left are made to sum to 1 again: nothing is left out
// and nothing guessed, but within half a cutoff of the ends the waviness is less sure. NaN stays NaN. Spacing and
// cutoff in m. Throws std::invalid_argument for a cutoff of fewer than five points or longer than the profile or map.
[[nodiscard]] std::vector<double> waviness(std::span<const double> profile, double spacing, double cutoff);
[[nodiscard]] HeightMap waviness(const HeightMap& map, double cutoff);

}  // namespace stillcut
