// Stability of milling by Floquet theory: is this cut stable, and up to which depth. Unlike the zeroth-order lobes this
// holds for small immersion and for structural modes near the tooth-passing frequency, where flip (period-2) lobes
// appear. The resolution follows from the answer: it is raised until the answer stops moving, and the last change is
// the error estimate.
#pragma once

#include <span>

#include "models/depth_limit.hpp"
#include "models/dynamics_map.hpp"
#include "models/linear_cut.hpp"

namespace stillcut {

struct FloquetPoint {
  double spectral_radius = 0.0;    // per period; below 1: stable
  double chatter_frequency = 0.0;  // rad/s, of the leading multiplier: its alias nearest the dominant mode
  Instability instability = Instability::hopf;
  double period = 0.0;          // s, the tooth period
  double error_estimate = 0.0;  // of the spectral radius
};

// Stability of one cut: modes in the feed frame, spindle speed in rad/s, axial depth in m. Throws std::invalid_argument
// for values out of range.
FloquetPoint floquet_point(const LinearCut& cut, std::span<const Mode> feed_frame_modes, double speed, double depth);

struct DepthSearch {
  double max_depth = 0.02;  // m
  double tolerance = 1e-4;  // relative, of the limit
};

// The depth limit at a spindle speed (rad/s), by a scan in depth from a thousandth of the largest depth in steps of 12
// %, with a closer look at peaks of the radius just below 1; an island narrower than that can be missed. Throws as
// above.
DepthLimit floquet_depth_limit(const LinearCut& cut, std::span<const Mode> feed_frame_modes, double speed,
                               const DepthSearch& search);

}  // namespace stillcut
