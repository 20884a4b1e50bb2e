// Where every point of a milling cutter's edges is at any time: the tool's shape, its runout, how it is inclined, how
// it travels along its passes and how it vibrates beside them (Liu et al. 2024, section 2.1 and eqs 25-27).
//
// Map axes: x along the feed of the first pass, y = z x x the cross-feed, z the surface's normal; z = 0 is the surface
// that a tool without runout and vibration just touches. The tool's axis keeps its direction as a zig-zag path turns
// round: tilt, lead and redundancy are those of the passes along +x.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "models/machining.hpp"

namespace stillcut {

// Motion of the tool point beside its path, in workpiece axes, as MillingSimulation gives it. `reach` and `speed` bound
// it: what is larger is not looked for. `at` is called from several threads at a time.
struct Displacement {
  std::function<Eigen::Vector3d(double)> at;        // m, of the time in s; empty: none
  Eigen::Vector3d reach = Eigen::Vector3d::Zero();  // m, largest magnitude of each component
  double speed = 0.0;                               // m/s, largest
};

// Samples (m; single precision is a thousandth of a nanometre) `step` s apart, the first one at `first_time`, with
// straight lines between; before and after them the tool stays where it was at the end. Throws std::invalid_argument
// for no samples or a step that is not positive.
[[nodiscard]] Displacement sampled_displacement(double first_time, double step, std::vector<Eigen::Vector3f> samples);

// A point of the edge in tool axes: its height is counted from the centre of the ball, or from an end mill's bottom.
struct EdgePoint {
  double radius = 0.0;  // m from the tool's axis
  double height = 0.0;  // m
  double lag = 0.0;     // rad that it trails the tip
};

[[nodiscard]] EdgePoint ball_edge_point(const Tool& tool, double kappa);     // eqs 1 and 3, kappa in rad
[[nodiscard]] EdgePoint bottom_edge_point(const Tool& tool, double radius);  // an end mill's bottom is flat
[[nodiscard]] EdgePoint wall_edge_point(const Tool& tool, double height);    // of its cylinder

// Of each tooth: how far its tip stands behind tooth 0, rad, and how much higher than without axial runout, m. One
// inclined bottom, not teeth of chance: what MillingSimulation makes of the same two numbers.
[[nodiscard]] std::vector<double> tooth_angles(const Tool& tool);
[[nodiscard]] std::vector<double> axial_offsets(const Tool& tool);

// Throws std::invalid_argument for a tool without teeth or diameter, or with a runout that it cannot have.
void check_teeth(const Tool& tool);

// A straight pass with constant feed along x. Time and spindle angle are those at its begin: with them passes follow
// each other as they do on a machine, and each can be given a phase of its own.
struct CutterPass {
  double begin = 0.0, length = 0.0;  // m: x at the begin; travelled
  double across = 0.0;               // m: y
  bool reversed = false;             // along -x
  double angle = 0.0;                // rad, tooth 0 clockwise from +y, seen along -z
  double time = 0.0;                 // s, that the displacement is asked for
};

struct CutterMotion {
  Tool tool;
  double spindle_speed = 0.0, feed_rate = 0.0;                   // rad/s, m/s
  Eigen::Matrix3d orientation = Eigen::Matrix3d::Identity();     // tool to map axes, eq. 5
  Eigen::Matrix3d from_workpiece = Eigen::Matrix3d::Identity();  // workpiece to map axes
  double height = 0.0;  // m of the ball's centre, or of the middle of an end mill's bottom, over the surface
  std::vector<double> tooth_angle;   // rad, of the tip behind tooth 0
  std::vector<double> axial_offset;  // m, upward
  Displacement displacement;

  [[nodiscard]] double inclination()
      const;  // rad between the tool's axis and the normal; on a ball the contact's kappa
};

// Throws std::invalid_argument for a tool without teeth or diameter, and for a cut whose feed, speed or depth is not
// positive.
[[nodiscard]] CutterMotion cutter_motion(const Tool& tool, const Cut& cut, Displacement displacement = {});

// The tool's displacement at a time in map axes, m.
[[nodiscard]] Eigen::Vector3d displacement_at(const CutterMotion& motion, double time);

// How far runout takes a tooth from where it should be while the spindle stands at an angle (rad, as tooth 0's), in
// spindle axes, m. The offset of eq. 4 turns with the spindle; its angle is counted like the teeth's, from tooth 0.
[[nodiscard]] Eigen::Vector3d runout_offset(const Tool& tool, double spindle_angle, double axial_offset);

// A point of tooth `tooth`, `time` s after the pass began: eqs 10 and 27, in map axes.
[[nodiscard]] Eigen::Vector3d edge_position(const CutterMotion& motion, const CutterPass& pass, std::size_t tooth,
                                            const EdgePoint& point, double time);

// Passes as a machine makes them, one after the other: `count` of them a step-over apart from y = `across` on, from x =
// `begin` (zig-zag: every second one back to it) over `length`, with `turn_time` s between two. Spindle and time go on.
[[nodiscard]] std::vector<CutterPass> parallel_passes(const CutterMotion& motion, const Cut& cut, double begin,
                                                      double length, double across, std::size_t count,
                                                      double turn_time = 0.0);

// What a pass is away from its neighbour, m: the cut's step-over, or where it says 0 its radial depth.
[[nodiscard]] inline double step_over_of(const Cut& cut) {
  return cut.step_over > 0.0 ? cut.step_over : cut.radial_depth;
}

}  // namespace stillcut
