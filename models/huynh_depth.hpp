// The question that the multibody paper leaves open (Huynh et al. 2017, section 5): how deep may its robot mill before
// the cut turns unstable. Two answers that share nothing but the robot and the law of force: stability lobes of the
// robot linearised at the posture, and the whole robot milling in time (models/milling_simulation).
#pragma once

#include <Eigen/Core>
#include <span>

#include "models/depth_limit.hpp"
#include "models/huynh_pass.hpp"

namespace stillcut {

// By Floquet theory with the modes of the posture `pass.place`, pitch and helix included (models/floquet), up to
// `max_depth`, m.
DepthLimit huynh_depth_by_lobes(const HuynhPass& pass, double max_depth);

// What the slowest dying (or fastest growing) vibration is multiplied by in a turn; below 1: stable.
struct TurnMultiplier {
  double modulus = 0.0;
  double frequency = 0.0;  // rad/s, its alias below a quarter of the spindle's frequency
};

// From the tool's places once every `turns_apart` turns, m: what repeats every turn drops out, and what is left obeys a
// linear recurrence over the last ten places, fitted by least squares (Kumaresan and Tufts 1982, IEEE Trans. ASSP 30,
// 833): its leading eigenvalue. Throws std::invalid_argument for fewer than 40 places.
TurnMultiplier turn_multiplier(std::span<const Eigen::Vector2d> places, double turns_apart, double turn_time);

// The whole robot at the posture, `depth` (m) deep in a part without end, entered over 0.3 s and watched for `seconds`.
// Throws as MillingSimulation.
TurnMultiplier huynh_multiplier_in_time(const HuynhPass& pass, double depth, double seconds = 0.8);

// The depth, m, at which that multiplier is 1, between 1 % below and above `near` (m), where its logarithm is taken for
// a straight line; NaN where it is not below 1 at the one and above 1 at the other.
double huynh_depth_in_time(const HuynhPass& pass, double near);

// The same in a part that is there (models/part_milling), whose face the tool meets at a slant, so that the cut deepens
// over a second and the robot is not knocked. Here the radial depth moves with the tool and the chip is that of the
// contours, both of which the lobes leave out. Four chords a step: the sagitta of one would be a chip of its own.
TurnMultiplier huynh_multiplier_in_part(const HuynhPass& pass, double depth, double seconds = 0.8);

// The depth, m, at which that multiplier is 1, by false position between four fifths and 1.2 of `near` (m); NaN where
// it is not below 1 at the one and above 1 at the other.
double huynh_depth_in_part(const HuynhPass& pass, double near);

}  // namespace stillcut
