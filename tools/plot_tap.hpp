// The picture of a tap test: the hammer's pulses, and of each response to them magnitude, phase and coherence.
#pragma once

#include <span>
#include <string>

#include "tools/plot.hpp"
#include "tools/tap_dialog.hpp"

namespace stillcut {

// `response`: all columns of the posture, by the estimator that was chosen.
[[nodiscard]] plot::Figure tap_figure(const std::string& title, std::span<const TappedDirection> directions,
                                      const FrequencyResponse& response);

}  // namespace stillcut
