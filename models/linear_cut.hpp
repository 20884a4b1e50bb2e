// The cut as linear stability theory sees it: small vibration around steady chip formation, where the force on the tool
// is F = -a [W (q - q_delayed) + C_p/v R q'], a the axial depth, q = (x, y) the tool's displacement in the feed frame.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "models/immersion.hpp"
#include "models/machining.hpp"

namespace stillcut {

using DirectionMatrix = Eigen::Matrix<double, 3, 2>;  // force (x, y, z) per displacement (x, y)

struct LinearCut {
  ToolShape shape = ToolShape::end;
  int teeth = 0;
  std::vector<double> pitch;  // rad, from each tooth to the one that cut before it, sum 2 pi; empty: equally spaced
  Immersion immersion;
  double ktc = 0.0, krc = 0.0, kac = 0.0;  // Pa
  double process_damping = 0.0;            // N/m, C_p
  double radius = 0.0;                     // m
  double lag_per_depth = 0.0;              // rad/m, helix: how far a tooth's edge trails per metre above the tip

  // Angle of the spindle after which the cut repeats: from tooth to tooth, or a whole turn where the pitch varies.
  double period_angle() const { return pitch.empty() ? kTwoPi / teeth : kTwoPi; }
};

// What the linear theory needs of a cell. A ball end keeps its immersion at every height and lags by its constant lead
// (surface paper, eq. 3). Throws std::invalid_argument for values out of range.
LinearCut linear_cut(const Tool& tool, const Material& material, const Cut& cut);

// Parts of the cell that the lobes leave out, one line each; empty when everything is covered.
std::vector<std::string> linear_cut_warnings(const Tool& tool, const Cut& cut);

// Integral over tooth angles [from, to] of the cutting stiffness of one tooth, W = w n^T with n = (sin, cos) the chip's
// normal and w = (kt cos + kr sin, -kt sin + kr cos, ka) the force that opposes it (Pa rad). With the axes of
// docs/conventions.md the axial force pulls the tool toward -z.
DirectionMatrix cutting_stiffness_integral(const LinearCut& cut, double from, double to);

// The same for the flank's radial force per radial speed: n n^T (rad).
DirectionMatrix radial_projection_integral(double from, double to);

// Force direction w and chip normal n of one tooth at an angle; W = w n^T.
Eigen::Vector3d cutting_force_direction(const LinearCut& cut, double angle);
Eigen::Vector2d chip_normal(double angle);

}  // namespace stillcut
