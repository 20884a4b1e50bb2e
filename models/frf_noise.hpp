// How noisy a measured frequency response is, line by line, out of itself: nobody writes it into the file.
#pragma once

#include <vector>

#include "models/frf_lines.hpp"

namespace stillcut {

// E |error|^2 of each value, (m/N)^2, out of what a fit left over (all of it where nothing is fitted yet). The variance
// is taken as a sum of what noise is in practice: the same share of every value, and white in receptance, mobility or
// accelerance, in amounts that make the remainder most probable; corrected by the medians of blocks of lines for what
// is none of these.
[[nodiscard]] std::vector<Eigen::VectorXd> noise_of_remainder(const FrfLines& lines,
                                                              const std::vector<Eigen::VectorXcd>& left_over);

// The same of the second differences over the lines, in which modes that are not fitted yet hardly show. Too low where
// neighbouring lines share their noise.
[[nodiscard]] std::vector<Eigen::VectorXd> noise_of_differences(const FrfLines& lines,
                                                                const std::vector<Eigen::VectorXcd>& left_over);

[[nodiscard]] FrfWeights weights_of(const std::vector<Eigen::VectorXd>& variances);

// How many lines say the same: 1 where the remainder of neighbours is independent, more where a window smeared it or
// where the model is not what was measured. Variances of what is fitted grow by it.
[[nodiscard]] double lines_alike(const std::vector<Eigen::VectorXcd>& left_over, const FrfWeights& weights);

}  // namespace stillcut
