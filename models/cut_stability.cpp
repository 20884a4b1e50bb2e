#include "models/cut_stability.hpp"

#include <cmath>

namespace stillcut {

CutStability cut_stability(const LinearCut& cut, std::span<const Mode> modes, double speed, double depth) {
  const FloquetPoint point = floquet_point(cut, modes, speed, depth);
  const bool stable = point.spectral_radius < 1.0;
  const auto turns_at = [&](double other_depth) {
    return (floquet_point(cut, modes, speed, other_depth).spectral_radius < 1.0) != stable;
  };
  const bool near = std::abs(point.spectral_radius - 1.0) <= point.error_estimate ||
                    turns_at(depth * (1.0 - kNearLimitDepth)) || turns_at(depth * (1.0 + kNearLimitDepth));
  return {point, near ? Verdict::near_limit : stable ? Verdict::stable : Verdict::unstable};
}

}  // namespace stillcut
