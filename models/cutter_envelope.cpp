#include "models/cutter_envelope.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <stdexcept>
#include <string>

namespace stillcut {
namespace {

constexpr double kBall = 0.5 * std::numbers::pi;  // kappa where the ball ends and the shank begins

std::string filled_in(const char* format, double a, double b) {
  char buffer[240];
  (void)std::snprintf(buffer, sizeof buffer, format, a, b);
  return buffer;
}

double arc_height(double radius, double away) {
  return away < radius ? radius - std::sqrt(radius * radius - away * away) : std::numeric_limits<double>::infinity();
}

// An end mill's corner circle seen along the feed is an ellipse: half as wide as this.
double corner_half_width(const CutterMotion& motion) {
  return 0.5 * motion.tool.diameter * std::hypot(motion.orientation(1, 0), motion.orientation(1, 1));
}

// Lowest height of the corner circle at a distance across from its middle.
double corner_height(const CutterMotion& motion, double across) {
  const Eigen::Matrix3d& o = motion.orientation;
  const double radius = 0.5 * motion.tool.diameter, width = corner_half_width(motion);
  const double part = std::clamp(across / width, -1.0, 1.0), other = std::sqrt(1.0 - part * part);
  const double length = std::hypot(o(1, 0), o(1, 1)), ux = o(1, 0) / length, uy = o(1, 1) / length;
  const double along_u = o(2, 0) * ux + o(2, 1) * uy, along_v = -o(2, 0) * uy + o(2, 1) * ux;
  return motion.height + radius * (part * along_u - other * std::abs(along_v));
}

// The corner's height is convex across, so two neighbours meet where the one rises to the other, or where one of them
// ends: there the wall of the tool begins, steeper than anything else.
double corner_ridge(const CutterMotion& motion, double step_over) {
  const double width = corner_half_width(motion);
  double low = step_over - width, high = width;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    const bool risen = corner_height(motion, middle) > corner_height(motion, middle - step_over);
    (risen ? high : low) = middle;
  }
  return std::max(corner_height(motion, low), corner_height(motion, low - step_over));
}

void check_contact(const CutterMotion& motion, const SweptHeights& swept) {
  if (!(motion.orientation(2, 2) > 0.0))
    throw std::invalid_argument(
        filled_in("tilt and lead: turn the tool by %.1f degrees from the normal; it touches only "
                  "below %.0f",
                  rad_to_deg(motion.inclination()), 90.0));
  if (motion.tool.shape != ToolShape::ball) return;
  const double radius = 0.5 * motion.tool.diameter;
  // Then no inclination would do, and the angles are not to blame.
  if (swept.reach >= radius)
    throw std::invalid_argument(
        filled_in("feed, step-over and runout: edges farther from the tip than the ball's radius of %.4g mm could mark "
                  "the surface, with %.4g mm of feed a turn; lower the largest of them",
                  1e3 * radius, 1e3 * kTwoPi * motion.feed_rate / motion.spindle_speed));
  const double room = kBall - std::asin(swept.reach / radius);
  if (motion.inclination() > room)
    throw std::invalid_argument(
        filled_in("tilt and lead: turn the contact by %.1f degrees from the tip onto the shank; the "
                  "ball cuts the surface alone up to %.1f",
                  rad_to_deg(motion.inclination()), rad_to_deg(room)));
}

}  // namespace

double scallop_height(const CutterMotion& motion, double step_over) {
  const bool ball = motion.tool.shape == ToolShape::ball;
  const double widest = ball ? motion.tool.diameter : 2.0 * corner_half_width(motion);
  if (!(step_over > 0.0 && step_over < widest))
    throw std::invalid_argument(
        filled_in("step-over: %.4g mm must be positive and less than the %.4g mm that the tool is "
                  "wide",
                  1e3 * step_over, 1e3 * widest));
  return ball ? arc_height(0.5 * motion.tool.diameter, 0.5 * step_over) : corner_ridge(motion, step_over);
}

SweptHeights swept_heights(const CutterMotion& motion, const Cut& cut) {
  const double step_over = step_over_of(cut), ridge = scallop_height(motion, step_over);
  if (ridge > cut.axial_depth)
    throw std::invalid_argument(filled_in("step-over: leaves ridges of %.4g mm, higher than the axial depth of %.4g mm",
                                          1e3 * ridge, 1e3 * cut.axial_depth));
  SweptHeights swept;
  // Runout turns with the spindle, so it lies in the plane of the bottom; axial runout along the tool's axis.
  const Eigen::Matrix3d& o = motion.orientation;
  const Eigen::Matrix3d turned = motion.from_workpiece.cwiseAbs();
  for (int i = 0; i < 3; ++i)
    swept.beside[i] = motion.tool.runout * std::hypot(o(i, 0), o(i, 1)) + std::abs(motion.tool.axial_runout * o(i, 2)) +
                      turned.row(i).dot(motion.displacement.reach);
  // The worst that can be: one tooth alone cuts, once a turn, as far off as it can be, once to this side, once to that.
  const double radius = 0.5 * motion.tool.diameter;
  const double along = motion.feed_rate * kTwoPi / motion.spindle_speed + 2.0 * swept.beside.x();
  const double across = step_over + 2.0 * swept.beside.y();
  if (motion.tool.shape == ToolShape::ball) {
    swept.highest = arc_height(radius, std::hypot(along, 0.5 * across)) + swept.beside.z();
    const double angle = std::acos(std::clamp(1.0 - (swept.highest + swept.beside.z()) / radius, 0.0, 1.0));
    swept.reach = radius * std::sin(angle) + swept.beside.head<2>().norm();
  } else {
    const double slope = std::tan(motion.inclination());
    swept.highest = (across < 2.0 * corner_half_width(motion) ? corner_ridge(motion, across) : radius) + along * slope +
                    swept.beside.z();
    swept.reach = radius + swept.beside.head<2>().norm() + swept.highest * slope;
  }
  check_contact(motion, swept);
  return swept;
}

}  // namespace stillcut
