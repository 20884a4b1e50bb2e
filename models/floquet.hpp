// Stability of milling by Floquet theory: is this cut stable, and up to which depth. Unlike the zeroth-order lobes this
// holds for small immersion and for structural modes near the tooth-passing frequency, where flip (period-2) lobes
// appear. The resolution follows from the answer: it is raised until the answer stops moving, and the last change is
// the error estimate.
#pragma once

#include <optional>
#include <span>

#include "models/depth_limit.hpp"
#include "models/dynamics_map.hpp"
#include "models/linear_cut.hpp"
#include "models/period_operator.hpp"

namespace stillcut {

// How finely to solve. Level 0 gives the spectral radius within 1e-5 of max(1, radius), level 1 within 1e-8; found on
// random cuts with stability_resolution_test, and confirmed in every answer by a run at the next level.
Collocation resolution(int level);
inline constexpr int kFinestLevel = 4;

// The cut at one spindle speed (rad/s), at any depth: keeps what does not depend on the depth. One thread at a time.
// `cut` and the modes (feed frame) must outlive it.
class CutAtSpeed {
 public:
  CutAtSpeed(const LinearCut& cut, std::span<const Mode> feed_frame_modes, double speed, int level);

  // Another speed, with the same memory.
  void move_to(double speed);
  // Spectral radius at a depth in m. A tolerance below that of the level adds nothing.
  double radius(double depth, double tolerance = 1e-7);

  struct Multiplier {
    std::complex<double> value;
    double frequency = 0.0;  // rad/s: its alias nearest the dominant mode
    Instability instability = Instability::hopf;
  };
  Multiplier leading(double depth, double tolerance = 1e-10);
  [[nodiscard]] double period() const { return cut_.period_angle() / speed_; }  // s

 private:
  LeadingMultiplier solve(double depth, double tolerance);

  const LinearCut& cut_;
  std::span<const Mode> modes_;
  double speed_;
  Collocation collocation_;
  std::optional<PeriodMap> map_;
  double map_depth_ = 0.0;  // the depth that the map is for, or the deepest that it is accurate at
  PeriodOperator operator_;
  Arnoldi arnoldi_;
};

struct FloquetPoint {
  double spectral_radius = 0.0;    // per period; below 1: stable
  double chatter_frequency = 0.0;  // rad/s, of the leading multiplier: its alias nearest the dominant mode
  Instability instability = Instability::hopf;
  double period = 0.0;          // s: from tooth to tooth, or of the spindle where the pitch varies
  double error_estimate = 0.0;  // of the spectral radius
};

// Stability of one cut: modes in the feed frame, spindle speed in rad/s, axial depth in m. Throws std::invalid_argument
// for values out of range.
FloquetPoint floquet_point(const LinearCut& cut, std::span<const Mode> feed_frame_modes, double speed, double depth);

struct DepthSearch {
  double max_depth = 0.02;  // m
  double tolerance = 1e-4;  // relative, of the limit
};

// The depth limit at a spindle speed (rad/s), by a scan in depth from a 500th of the largest depth in steps of 15 %,
// with a closer look at peaks of the radius just below 1; an island narrower than that can be missed. Throws as above.
DepthLimit floquet_depth_limit(const LinearCut& cut, std::span<const Mode> feed_frame_modes, double speed,
                               const DepthSearch& search);

}  // namespace stillcut
