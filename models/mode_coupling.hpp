// Mode coupling: chatter without regeneration. Two close modes of the structure at an angle to the cutting force can
// feed each other: the tool runs round an ellipse and takes energy from the cut even where every tooth meets a smooth
// surface. Robots do so at their own 8 to 25 Hz (Pan, Zhang, Zhu, Wang 2006, J. Mater. Process. Technol. 173). The
// depth at which it begins does not depend on the spindle speed: a horizontal line in the lobe diagram.
#pragma once

#include <limits>
#include <span>

#include "models/dynamics_map.hpp"
#include "models/linear_cut.hpp"

namespace stillcut {

struct ModeCouplingLimit {
  double depth = 0.0;      // m, the smallest at which the structure turns unstable; +inf: none up to the largest asked;
                           // NaN: unstable at every depth (only without damping)
  double frequency = 0.0;  // rad/s; 0: the cut pulls the tool in without vibration; NaN where depth is not finite
};

// The cutting stiffness per axial depth, averaged over a turn of the tool with all of its teeth (Pa): the mean force on
// the tool is F = -a W q for a displacement q that the surface does not remember (docs/conventions.md).
DirectionMatrix mean_cutting_stiffness(const LinearCut& cut);

// A mean over the turning tool describes vibration that is slow beside its teeth: give the tooth-passing frequency as
// the highest to be looked for. Faster modes still lend their compliance.

// The limit of the damped structure, M q'' + C q' + (K + a W) q = 0 in modal coordinates: the smallest depth a with an
// eigenvalue on the imaginary axis, which lie where det[I + a G(iw) W] = 0, G the receptance. Modes in the feed frame,
// depth in m, frequency in rad/s. Process damping, which would depend on the spindle speed, is left out. Throws
// std::invalid_argument for modes that are not physical and a depth that is not positive.
ModeCouplingLimit mode_coupling_limit(const LinearCut& cut, std::span<const Mode> feed_frame_modes, double max_depth,
                                      double highest_frequency = std::numeric_limits<double>::infinity());

// The paper's criterion, without damping: the smallest depth at which an eigenvalue of M^-1 (K + a W) (the paper's
// K - K_process) turns complex or negative. Modes of equal frequency may do so at once; damping may raise the limit as
// well as lower it. Depths are scanned from a thousandth of the largest in steps of 3 %. Its cost grows with the cube
// of the number of modes. Throws as above.
ModeCouplingLimit undamped_mode_coupling_limit(const LinearCut& cut, std::span<const Mode> feed_frame_modes,
                                               double max_depth,
                                               double highest_frequency = std::numeric_limits<double>::infinity());

}  // namespace stillcut
