// From hammer hits to the frequency response of the tool point: windows, averages over the hits, three estimators and
// coherence. docs/tap-tests.md has the equations.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "models/dynamics_map.hpp"
#include "models/frequency_response.hpp"
#include "models/tap_hits.hpp"

namespace stillcut {

struct TapEstimate {
  // Receptance of what was measured, in the column of the hammer's axis: h1 is right where the responses are noisy, h2
  // where the force is, hv, their geometric mean, where both are alike.
  FrequencyResponse h1, h2, hv;
  std::array<std::vector<double>, 3>
      coherence;                       // of each axis, 0 to 1; NaN from a single hit, which agrees with itself
  std::vector<double> force_spectrum;  // root mean square over the hits, N s: where the hammer excites
  std::vector<TapHit> hits;            // all that were found
  std::size_t hits_used = 0;
  double resolution_hz = 0.0;  // spacing of the frequencies: 1 / record length
  // What the exponential window adds to the decay rate of every mode, 1/s: a mode fitted to these responses is given
  // its own damping again by without_added_decay().
  double added_decay_per_s = 0.0;
};

// Of all recordings' sound hits together. Throws std::invalid_argument, in words for the operator, for what
// require_sound_taps() refuses, recordings that differ in rate or axes, and where no hit can be used (each with its
// reason).
[[nodiscard]] TapEstimate estimate_taps(std::span<const TapRecording> recordings, const TapSettings& settings);

// The mode itself, of one fitted to windowed responses: modal mass and damped frequency stay, the decay rate loses what
// the window added. Throws std::invalid_argument where that leaves no damping.
[[nodiscard]] Mode without_added_decay(const Mode& fitted, double added_decay_per_s);

}  // namespace stillcut
