// What a hammer test shows of a set of modes: how far the tool point moves at most for a force of 1 N at a frequency,
// and at which frequencies that has peaks.
#pragma once

#include <span>
#include <vector>

#include "models/dynamics_map.hpp"

namespace stillcut {

// The largest singular value of the receptance tensor at a frequency (rad/s): m/N, over all directions of force and
// motion.
double largest_receptance(std::span<const Mode> modes, double frequency);

// Frequencies (rad/s, rising, equally spaced on a logarithmic scale) on which no peak of the modes falls between: from
// 0.7 of the lowest natural frequency to 1.4 of the highest, `per_peak` steps to a half-width of the sharpest peak. At
// most 20 000. Throws std::invalid_argument as check_modes does.
std::vector<double> peak_frequencies(std::span<const Mode> modes, double per_peak = 4.0);

struct ReceptancePeak {
  double frequency = 0.0;   // rad/s
  double receptance = 0.0;  // m/N, the largest singular value there
};

// The peaks of largest_receptance, in rising frequency: maxima that stand out by 5 % at least over the lowest point
// between them and any higher one, so that a ripple counts as none. The highest maximum always counts. Throws
// std::invalid_argument as check_modes does.
std::vector<ReceptancePeak> receptance_peaks(std::span<const Mode> modes);

// The highest of them; there must be one.
ReceptancePeak highest_peak(std::span<const ReceptancePeak> peaks);

}  // namespace stillcut
