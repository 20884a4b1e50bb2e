// What a robot's description predicts, mended by what a hammer measured: at measured postures the measurement stands,
// elsewhere the robot's modes are scaled as the measured ones say.
#pragma once

#include <functional>
#include <vector>

#include "models/dynamics_map.hpp"

namespace stillcut {

// The modes that the description gives at a posture, always as many and in the same order.
using RobotModes = std::function<std::vector<Mode>(const Posture&)>;

// How a robot mode was found in the measurements.
struct ModeMatch {
  int found = 0;                                                       // measured postures at which it was
  double lowest_frequency_ratio = 0.0, highest_frequency_ratio = 0.0;  // measured over predicted
};

struct CorrectedMap {
  DynamicsMap map;                 // the measured postures, then the predicted ones that nobody measured
  std::vector<ModeMatch> matches;  // one a robot mode
};

// At every measured posture each robot mode is matched to at most one measured mode: within a factor of two in
// frequency and 60 degrees in direction, the nearest pairs first (|ln of the frequency ratio| + 1 - |cos|). What the
// pairs say, measured over predicted in frequency, stiffness and damping, is weighed at a predicted posture by inverse
// distance in joint space (models/posture), as logarithms; the mode keeps the description's direction. A mode matched
// nowhere stays as it is described. Measured modes without a partner (tool, holder, spindle: a description of rigid
// links has none) are taken over from the nearest measured posture.
//
// `predicted` has joints, and its modes are those of `robot`. Throws std::invalid_argument for a measured map that is
// empty or has no joints, and whatever `robot` throws.
CorrectedMap corrected_map(const DynamicsMap& measured, const DynamicsMap& predicted, const RobotModes& robot);

}  // namespace stillcut
