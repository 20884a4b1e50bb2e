// Cutting coefficients by the average-force method: mean forces of full slots, milled at several feeds per tooth, are
// linear in the six coefficients; least squares gives them back with their standard errors (Altintas, Manufacturing
// Automation, sec. 2.8; for ball ends Gradisek, Kalveram, Weinert 2004). Signs and frames: docs/conventions.md.
#pragma once

#include <Eigen/Core>
#include <array>
#include <limits>
#include <string>
#include <vector>

#include "models/machining.hpp"

namespace stillcut {

struct SlotTest {
  double feed_per_tooth = 0.0;                           // m
  double axial_depth = 0.0;                              // m
  Eigen::Vector3d mean_force = Eigen::Vector3d::Zero();  // N on the tool, over whole turns, feed frame
};

// ktc, krc, kac in Pa, then kte, kre, kae in N/m: the order of all that has six entries here.
using SixCoefficients = Eigen::Matrix<double, 6, 1>;
[[nodiscard]] SixCoefficients six_coefficients(const Material& material);

// The mean force of a slot is this matrix times the six coefficients. The edge elements are those of the milling
// simulation, integrated over the immersion 0..pi in closed form. Helix, unequal pitch and runout do not change what
// all teeth cut together in a turn, so they do not enter, but for the length of a ball's edge; a tooth that runout
// keeps out of the part for some of its arc loses edge force there (arc_out_of_cut).
[[nodiscard]] Eigen::Matrix<double, 3, 6> slot_influence(const Tool& tool, double feed_per_tooth, double axial_depth);

// The share of the slot that teeth spend out of the part, mean over the teeth, because a tooth before them runs further
// out; 0 without runout.
[[nodiscard]] double arc_out_of_cut(const Tool& tool, double feed_per_tooth);

// What the linear model leaves in an axis that grows with the square of the feed or the depth.
struct ResidualPattern {
  double significance = 0.0;  // standard deviations of a normal distribution; 0: the tests cannot show it
  double share = 0.0;         // what it adds at most, relative to the axis' largest force
};

struct AxisFit {
  double r_squared = std::numeric_limits<double>::quiet_NaN();  // NaN where the force is the same in all tests
  double scatter = 0.0;                                         // N, standard deviation of a mean force
  double freedom = 0.0;                                         // tests less what the fit took from this axis
  ResidualPattern feed_squared, depth_squared;
};

struct SlotFit {
  SixCoefficients value = SixCoefficients::Zero(), standard_error = SixCoefficients::Zero();
  std::array<AxisFit, 3> axes;
  double condition = 1.0;  // of the scaled equations: 1, every coefficient by itself; large, hardly told apart
  std::vector<Eigen::Vector3d> residual;  // N, measured less fitted, a test each
};

// Weighs each axis by its own scatter, which the residuals tell. Throws std::invalid_argument, in words for the user,
// for tests that cannot tell the coefficients apart: fewer than three, all at one feed, feeds too close to each other,
// a ball end without axial forces.
[[nodiscard]] SlotFit fit_slot_coefficients(const Tool& tool, const std::vector<SlotTest>& tests);

// What about a fit should not be believed without a second look, one line each.
[[nodiscard]] std::vector<std::string> doubts(const SlotFit& fit, const Tool& tool, const std::vector<SlotTest>& tests);

}  // namespace stillcut
