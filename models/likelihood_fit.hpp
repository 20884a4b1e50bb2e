// The modes that most probably gave what was measured, and how sure they are: weighted least squares with the weights
// of the noise, whose minimum has the covariance of the Cramer-Rao bound.
#pragma once

#include "models/modal_model.hpp"

namespace stillcut {

struct LikelihoodFit {
  ModalModel model;
  double chi_square = 0.0;
  Eigen::MatrixXd covariance;  // of the parameters of ModalModel; 0 for those that no entry shows
};

// When it is near enough: after so many steps, or when chi square falls by less in one, a standard deviation of a
// figure being 1, or by less than a share of itself.
struct FitEffort {
  int most_steps = 40;
  double least_gain = 1e-3, least_share = 1e-9;
};

// Levenberg-Marquardt from a start; never farther off than that.
[[nodiscard]] LikelihoodFit fit_likelihood(ModalModel start, const FrfLines& lines, const FrfWeights& weights,
                                           const FitEffort& effort = {});

// The model with these poles alone that fits best: residue by residue (a linear problem), each as a vector.
[[nodiscard]] ModalModel model_of_poles(const std::vector<Pole>& poles, const FrfLines& lines,
                                        const FrfWeights& weights);

// How far a term stands out of the noise: a^T C^-1 a, about 3 for none at all.
[[nodiscard]] double significance(const LikelihoodFit& fit, std::size_t term);

// One standard deviation of |a|, relative. Where two terms stand for one mode it is above 1: what one has the other may
// have as well.
[[nodiscard]] double size_deviation(const LikelihoodFit& fit, std::size_t term);

}  // namespace stillcut
