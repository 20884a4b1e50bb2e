// How often what stands on a surface repeats, along the feed and across it: feed marks, steps between paths, chatter
// marks.
#pragma once

#include <cstddef>
#include <vector>

#include "models/surface_profiles.hpp"

namespace stillcut {

// Mean power over the profiles of one direction, the parabola of each removed first.
struct TextureSpectrum {
  std::vector<double> frequencies;         // waves a metre, equally spaced from 0 on
  std::vector<double> densities;           // m³: their sum times the frequencies' spacing is the mean square
  std::size_t profiles = 0, left_out = 0;  // left out: more than a tenth of its points is not known
  double length = 0.0;                     // m, of a profile
};

// Hann window, which parts lines of unequal height; four times as many frequencies as the profile resolves, for a
// smooth curve. Points not known weigh nothing. Throws std::invalid_argument for profiles of fewer than eight points,
// and where none is known well enough.
[[nodiscard]] TextureSpectrum texture_spectrum(const HeightMap& map, ProfileDirection direction);

struct TextureInterval {
  double interval = 0.0;  // m; NaN where nothing repeats twice within a profile
  double share = 0.0;     // of the power that is in it, 0..1: near 1 for one wave, near 0 for noise
};

// Of the strongest line that repeats at least twice within a profile, found between the frequencies by a parabola.
[[nodiscard]] TextureInterval texture_interval(const TextureSpectrum& spectrum);

// Mean width of profile elements, a hill and the valley beside it (R_Sm of ISO 4287): what the eye counts where no line
// stands out. Hills and valleys lower than a tenth of the profile's total height are not counted. Mean over the
// profiles, their least-squares line removed, m; NaN where none has two elements or is known well enough.
[[nodiscard]] double mean_element_width(const HeightMap& map, ProfileDirection direction);

}  // namespace stillcut
