// Modes as they are read off a plot: the baseline that an identification is held against.
#pragma once

#include <vector>

#include "models/dynamics_map.hpp"
#include "models/frequency_response.hpp"

namespace stillcut {

// Peaks of the sum of the measured entries' squares, higher than everything within 3 % and than a thousandth of the
// highest; damping from the width at half the power, between lines straight; stiffness and direction from the
// imaginary parts at the peak, 1/(2 k zeta) u u^T. In rising frequency. Peaks whose half-power points are not
// measured, or lie in another peak, and those of which no direct response is known, are left out.
[[nodiscard]] std::vector<Mode> pick_peaks(const FrequencyResponse& response);

}  // namespace stillcut
