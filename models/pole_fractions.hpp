// Poles as the zeros of the common denominator of rational fractions, the same for all entries: a linear problem that
// needs no start, in two kinds of polynomials.
//
// lscf: powers of z = exp(-i w T) (least-squares complex frequency, Guillaume, Verboven and Vanlanduit 1998).
// polynomials: Chebyshev's way to polynomials that are orthogonal over the lines (Forsythe 1957; surface paper, section
// 4.1; rational fraction polynomials of Richardson and Formenti 1982).
#pragma once

#include <vector>

#include "models/modal_model.hpp"
#include "models/stabilization_chart.hpp"

namespace stillcut {

struct FractionPole {
  Pole pole;
  Eigen::VectorXcd shape;  // residue of every entry, of length 1
};

// One list for each number of pairs of poles from 1 to `most_pairs` (fewer where there are too few lines): those that
// decay, with less than half of critical damping, in rising frequency.
[[nodiscard]] std::vector<std::vector<FractionPole>> fraction_poles(const FrfLines& band, const FrfWeights& weights,
                                                                    int most_pairs, PoleMethod method);

}  // namespace stillcut
