// What chatter tells about a dynamics map. The frequency at which a cut chatters follows from speed, depth and the mode
// behind it; where it is heard at another frequency than the stability lobes say, that mode's natural frequency is off.
// Small shifts, many observations, their median against their scatter: a proposal, which a person accepts or not.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "models/dynamics_map.hpp"
#include "models/linear_cut.hpp"

namespace stillcut {

struct HeardChatter {
  double spindle_speed = 0.0;  // rad/s
  double axial_depth = 0.0;    // m
  double frequency = 0.0;      // rad/s
};

// Of one mode's natural frequency: heard over mapped.
struct ModeShift {
  std::size_t mode = 0;
  double ratio = 1.0;
};

inline constexpr double kMostModeShift = 0.05;  // relative; what is farther off is no small error of a tap test

// Which mode's natural frequency, and by what ratio, must differ for the Floquet solution to give the frequency that
// was heard: that of the multiplier which grows at this depth, or, where the map calls the cut stable, which would grow
// first with depth. The frequency is taken modulo the tooth-passing frequency, mirrored or not, as both are heard.
// Nothing where that leaves it open which of its aliases was heard, where not one mode alone carries the vibration (or
// none does: a flip stands where the teeth put it), and where no shift up to kMostModeShift explains it. Modes in the
// feed frame. Throws std::invalid_argument as floquet_point does.
std::optional<ModeShift> shift_of_mode(const LinearCut& cut, std::span<const Mode> feed_frame_modes,
                                       const HeardChatter& heard);

// A shift seen once, at a posture of the map.
struct ShiftObservation {
  std::size_t posture = 0, mode = 0;
  double ratio = 1.0;
};

struct RefinementSettings {
  std::size_t least_observations = 5;
  double standard_errors = 4.0;  // a shift must exceed so many
  double least_shift = 0.008;    // relative, and this: what errors of stiffness, damping and depth pass for
};

// Observations of one mode at one posture, together.
struct ModeEvidence {
  std::size_t posture = 0, mode = 0, observations = 0;
  double ratio = 1.0;           // their median
  double standard_error = 0.0;  // of the median, from the median absolute deviation; at least a 1000th
  bool proposed = false;        // enough of them, and beyond their scatter
};

// One for each mode that was observed, by posture and mode.
std::vector<ModeEvidence> weigh_shifts(std::vector<ShiftObservation> observations, const RefinementSettings& settings);

}  // namespace stillcut
