// How deep a cut may be at one spindle speed, whichever theory says so.
#pragma once

namespace stillcut {

// How the cut becomes unstable: a multiplier leaves the unit circle as a pair e^{+-ia} (vibration at a frequency of its
// own), at -1 (period two) or at +1.
enum class Instability { hopf, flip, fold };

struct DepthLimit {
  double depth = 0.0;  // m, the smallest depth at which the cut turns unstable; +inf: none up to the largest
                       // asked; NaN: unstable at every depth
  double chatter_frequency = 0.0;  // rad/s; NaN where depth is not finite
  Instability instability = Instability::hopf;
  double error_estimate = 0.0;  // relative, of depth, from the last refinement
};

}  // namespace stillcut
