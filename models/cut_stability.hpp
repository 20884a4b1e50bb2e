// Is this one cut stable? The Floquet answer put as a verdict that a machinist can use: stable, unstable, or so near
// the limit that a little more or less depth would turn it.
#pragma once

#include <span>

#include "models/floquet.hpp"

namespace stillcut {

enum class Verdict { stable, near_limit, unstable };

// Relative change of the axial depth that must leave the verdict as it is, or the cut counts as near the limit: no
// dynamics map and no cutting coefficient is known better.
inline constexpr double kNearLimitDepth = 0.05;

struct CutStability {
  FloquetPoint point;
  Verdict verdict = Verdict::stable;
};

// Modes in the feed frame, spindle speed in rad/s, axial depth in m; depth 0 is the free structure. Near the limit is a
// cut whose verdict differs at a depth kNearLimitDepth smaller or larger, or whose radius is nearer to 1 than its
// numerical error. Throws std::invalid_argument as floquet_point does.
CutStability cut_stability(const LinearCut& cut, std::span<const Mode> feed_frame_modes, double speed, double depth);

}  // namespace stillcut
