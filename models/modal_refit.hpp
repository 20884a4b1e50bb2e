// Fewer modes for the same response. `frf` interpolation superposes the modes of every posture (49 postures of four
// modes make 196), more than the stability solution takes; this finds a few modes whose receptance is nearly the same
// and says how nearly.
#pragma once

#include <span>
#include <vector>

#include "models/interpolation.hpp"

namespace stillcut {

inline constexpr std::size_t kMostRefitModes = 12;  // what the stability solution is to be used with

// Relative errors of one receptance tensor beside another, G: norm(difference)/norm(G), Frobenius norms, over
// frequencies that resolve every peak of G (models/receptance_peaks).
struct ReceptanceError {
  double at_peak = 0.0;  // at the highest peak of G
  double rms = 0.0;      // root mean square over the band, log frequency
  double worst = 0.0;    // the largest over the band
};

// Throws std::invalid_argument where a mode is not physical.
ReceptanceError receptance_error(std::span<const Mode> modes, std::span<const Mode> reference);

struct ModalRefit {
  std::vector<Mode> modes;  // rising frequency; every one physical
  ReceptanceError error;    // of their receptance beside that of the modes given
};

// At most `most` modes with the receptance of the modes given. Copies of a mode (equal frequency, damping and
// direction) become one with the sum of their compliances, exactly; if then `most` suffice, the result is exact. Else
// modes are joined, always the two whose joining costs least, and the result is polished by least squares
// (models/modal_polish). Physical by construction, deterministic. Throws std::invalid_argument where a mode is not
// physical or `most` is 0.
ModalRefit refit_modes(std::span<const Mode> modes, std::size_t most = kMostRefitModes);

// For the stability solution: more than `most` superposed modes are fitted by kMostRefitModes, and the prediction says
// so (fitted_from, fit_error). Every other prediction comes back as it is.
PredictedPosture with_few_modes(PredictedPosture predicted, std::size_t most = kMostRefitModes);

}  // namespace stillcut
