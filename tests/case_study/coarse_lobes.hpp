// Zeroth-order limits with the paper's projection, quickly and a per cent or so off: for a search that asks for a
// hundred thousand of them. What it finds is judged by models/direction_limits.
#pragma once

#include <complex>
#include <span>
#include <vector>

#include "models/dynamics_map.hpp"
#include "models/linear_cut.hpp"

namespace stillcut::case_study {

// Direct receptances at rising frequencies; the paper has no others.
struct DirectReceptance {
  std::vector<double> frequencies;           // rad/s
  std::vector<std::complex<double>> xx, yy;  // m/N
};

// From 30 to 700 Hz, finer where the tool's modes lie.
DirectReceptance direct_receptance(std::span<const Mode> modes);

// One limit a speed (rad/s, rising, equally spaced), in m; +inf where no lobe reaches.
std::vector<double> coarse_paper_limits(const LinearCut& cut, const DirectReceptance& receptance, double feed_direction,
                                        std::span<const double> speeds);

}  // namespace stillcut::case_study
