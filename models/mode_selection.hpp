// Which modes a measured response holds: from poles to start with, modes are taken away that no measurement needs and
// added where the remainder asks for one, until neither is worth its parameters (Schwarz 1978).
#pragma once

#include <functional>

#include "models/likelihood_fit.hpp"

namespace stillcut {

struct SelectedModes {
  LikelihoodFit fit;
  FrfWeights weights;  // by what the fit leaves over
  double alike = 1.0;  // lines that say the same (lines_alike): variances of what was fitted grow by it
};

// What chi square has to fall by for `parameters` more: more where it tells that the noise was taken too low.
[[nodiscard]] double price_of(const SelectedModes& modes, double parameters);

// In the band, with damping that a mode of a structure has.
[[nodiscard]] bool can_be_mode(const Pole& pole, const FrfLines& lines);

// Before anything is fitted.
[[nodiscard]] FrfWeights rough_weights(const FrfLines& lines);

// `progress` is told 0.3 to 0.8. There may be no mode in the result.
[[nodiscard]] SelectedModes select_modes(const FrfLines& lines, const std::vector<Pole>& start,
                                         const FrfWeights& weights, const std::function<void(double)>& progress = {});

// With just these modes, in this order, wherever the fit moves them.
[[nodiscard]] SelectedModes fit_poles(const FrfLines& lines, const std::vector<Pole>& poles, const FrfWeights& weights);

}  // namespace stillcut
