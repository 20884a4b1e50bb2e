// How sure a depth limit is: the modes of a posture and the cutting coefficients are known to some per cent only, so
// the limit is a distribution. The depth that is stable with a chosen probability lies below the nominal limit; a band
// around the lobes shows by how much.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "models/lobes.hpp"

namespace stillcut {

// Relative standard deviations of the modes that a map predicts. The defaults are what tap tests repeated by hand and
// inverse distance weighting typically leave; a map's own scatter (left_out_scatter) replaces them where it is known.
struct ModalScatter {
  double frequency = 0.03;
  double damping = 0.2;
  double stiffness = 0.1;
};

struct Tolerance {
  ModalScatter modes;
  double ktc = 0.1;  // of all cutting coefficients together: a material that is harder than thought is so in every one
};

struct Confidence {
  double probability = 0.95;  // 0.5 to 0.99
  int samples = 100;          // of the distribution; at least 0.5 / (1 - probability)
  std::uint64_t seed = 1;
};

struct DepthBand {
  double low = 0.0;   // m, stable with the chosen probability; 0: no depth is, +inf: the largest depth asked is
  double high = 0.0;  // m, unstable with the chosen probability; +inf: no depth up to the largest asked is
};

// One sample of a cell whose figures vary: every figure by its own lognormal factor whose median is 1.
struct UncertainCell {
  Material material;
  std::vector<Mode> modes;  // the number and order of the nominal ones; directions are left as they are
};

// `count` samples, each parameter stratified: its i-th smallest value stands for the i-th of `count` equal parts of its
// distribution (Latin hypercube, centred), parameters paired by `seed`. So a single uncertain figure gives exact
// quantiles, and the same question the same answer. Throws std::invalid_argument for a deviation outside [0, 1) or a
// count below 1.
std::vector<UncertainCell> sample_cells(const Material& material, std::span<const Mode> modes,
                                        const Tolerance& tolerance, int count, std::uint64_t seed);

// The depth below which a share of the samples' limits lies, by interpolation between them in log depth; `limits` are
// depths as DepthLimit has them: NaN (always unstable) counts as 0, +inf as +inf.
double depth_quantile(std::vector<double> limits, double share);

// The band at every speed (rad/s), modes in workpiece axes. Each sample's boundary is traced from speed to speed.
// Throws std::invalid_argument as depth_limits and sample_cells do and for a confidence out of range. `progress` is
// told the share done.
std::vector<DepthBand> depth_bands(const Tool& tool, const Material& material, const Cut& cut,
                                   std::span<const Mode> modes, std::span<const double> speeds,
                                   const LobeSettings& settings, const Tolerance& tolerance,
                                   const Confidence& confidence, const std::function<void(double)>& progress = {});

}  // namespace stillcut
