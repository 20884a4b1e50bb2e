// Where a mode is missing: what a fit left over, held against one more mode at every frequency and damping.
#pragma once

#include <vector>

#include "models/modal_model.hpp"

namespace stillcut {

struct MissingMode {
  Pole pole;
  double gain = 0.0;  // what chi square falls by at least, every entry's residue free; where nothing is missing about
                      // the number of entries
};

// For each of seven dampings from 0.1 to 40 % the mode that would explain most of it, the best first; nothing without
// lines.
[[nodiscard]] std::vector<MissingMode> missing_modes(const std::vector<Eigen::VectorXcd>& left_over,
                                                     const FrfLines& lines, const FrfWeights& weights);

}  // namespace stillcut
