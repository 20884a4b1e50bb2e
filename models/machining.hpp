// The cell as the physics sees it: tool, material, cut and spindle, in SI units (m, N, Pa, rad, rad/s).
// Conventions (angles, frames, signs) are those of docs/conventions.md.
#pragma once

#include <numbers>
#include <string>
#include <vector>

#include "models/milling_kind.hpp"

namespace stillcut {

inline constexpr double kTwoPi = 2.0 * std::numbers::pi;
inline constexpr double rpm_to_rad_s(double rpm) { return rpm * kTwoPi / 60.0; }
inline constexpr double rad_s_to_rpm(double speed) { return speed * 60.0 / kTwoPi; }
inline constexpr double deg_to_rad(double deg) { return deg * std::numbers::pi / 180.0; }
inline constexpr double rad_to_deg(double rad) { return rad * 180.0 / std::numbers::pi; }

enum class ToolShape { end, ball };
enum class PathKind { unidirectional, zigzag };

struct Tool {
  ToolShape shape = ToolShape::end;
  double diameter = 0.0;  // m
  int teeth = 0;
  std::vector<double> pitch;  // rad, one a tooth, sum 2 pi
  double helix = 0.0;         // rad
  double runout = 0.0;        // m, radial
  double runout_angle = 0.0;  // rad
  double axial_runout = 0.0;  // m
};

struct Material {
  std::string name;
  double ktc = 0.0, krc = 0.0, kac = 0.0;  // Pa, shear coefficients
  double kte = 0.0, kre = 0.0, kae = 0.0;  // N/m, edge coefficients
  double process_damping = 0.0;            // N/m, C_p
};

struct Cut {
  Milling milling = Milling::down;
  double radial_depth = 0.0;                        // m
  double axial_depth = 0.0;                         // m
  double feed_per_tooth = 0.0;                      // m
  double spindle_speed = 0.0;                       // rad/s
  double feed_direction = 0.0;                      // rad, from workpiece +X toward +Y
  double tilt = 0.0, lead = 0.0, redundancy = 0.0;  // rad
  double step_over = 0.0;                           // m; 0: the radial depth
  PathKind path = PathKind::unidirectional;
};

struct SpindleLimits {
  double min_speed = 0.0, max_speed = 0.0;  // rad/s
  double acceleration = 0.0;                // rad/s^2
  double jerk = 0.0;                        // rad/s^3
};

}  // namespace stillcut
