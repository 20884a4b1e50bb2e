// The multibody paper's milling passes (Huynh et al. 2017, sections 3 and 4): its four-axis robot (Tables 1 and 2)
// takes up its feed outside an aluminium plate, enters it and mills a shoulder (Table 3), along the arm or across it,
// down or up. What comes out is what the paper shows: forces, their spectrum, the tool's deviation, the roughness of
// the wall.
//
// What the paper does not print was chosen before any roughness was looked at, and is not tuned to it:
//  - posture: the tool 1.1 m in front of joint 1 at the height of its foot when the pass is measured, which is
//    huynh_robot()'s home: a table beside the robot, the arm well between folded (0.1 m) and stretched (1.8 m);
//  - start phase: tooth 0 on workpiece +y as the path begins, a hundred steps a turn exactly;
//  - eight discs of 0.2 mm; two seconds (123 mm) of plate before the measured end, so that the entry has died away;
//  - the wall: 4 mm (ISO 4288 for this R_a) of every slice, least-squares line removed, no filter, mean over the
//  slices.
#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <vector>

#include "models/machining.hpp"
#include "models/part_milling.hpp"
#include "models/surface_roughness.hpp"

namespace stillcut {

enum class PassWay { longitudinal, transversal };  // along x, the arm's own direction; along y

// Table 3 of the paper, its second coefficient read as K_rc (docs/conventions.md).
[[nodiscard]] Tool huynh_tool();
[[nodiscard]] Material huynh_material();
// Of Table 3 too; the feed per tooth is the mean one, the teeth being 170 and 190 degrees apart.
[[nodiscard]] Cut huynh_cut(PassWay way, Milling milling);

struct HuynhPass {
  PassWay way = PassWay::longitudinal;
  Milling milling = Milling::down;       // down or up
  Eigen::Vector3d place{1.1, 0.0, 0.0};  // m, base axes: where the tool is commanded to be at the end
  double steps_per_turn = 100.0;         // as in PartMillingSetup, as are
  int discs = 8, chords = 1;
  double axial_depth = 1.6e-3;                // m
  double start_angle = 0.0;                   // rad
  double runout = 0.0;                        // m
  double air_time = 0.2, cutting_time = 2.0;  // s: at full feed before the plate; in it
  double wall_length = 4e-3;                  // m, evaluated
  int measured_turns = 100;                   // of the forces, the last ones
};

// Amplitudes of a sum of sines at multiples of `resolution`, from 0 up.
struct Spectrum {
  double resolution = 0.0;  // Hz
  std::vector<double> amplitude;
};

// By Fourier sums over all samples, `step` s apart, up to `highest_hz`. Throws std::invalid_argument without samples.
Spectrum amplitude_spectrum(std::span<const double> samples, double step, double highest_hz);

// In the frame of the feed: `feed` along it, `cross` across it (z x feed); forces act on the tool.
struct HuynhPassResult {
  double step = 0.0;                                   // s
  double feed_peak = 0.0, feed_rms = 0.0;              // N
  double cross_peak = 0.0, cross_rms = 0.0;            // N
  double feed_mean = 0.0, cross_mean = 0.0;            // N
  std::array<double, 2> tooth_peak{};                  // N, cross-feed: largest of each tooth, mean over the turns
  Spectrum cross_spectrum;                             // N
  double deviation_mean = 0.0, deviation_peak = 0.0;   // m, of the tool across the feed; positive: into the part
  double feed_vibration = 0.0, cross_vibration = 0.0;  // m/s^2, rms of the tool's acceleration
  std::vector<ProfileRoughness> wall;                  // m, of every slice from the tip up
  std::vector<double> profile;  // m, the middle slice's wall, every micrometre, positive into the part
  std::vector<double> turns, feed_force, cross_force, deviation;  // the last two turns; N, m
};

// Mean over the slices, and the smallest and the largest R_a, R_q and R_t.
struct RoughnessRange {
  ProfileRoughness mean, low, high;
};
RoughnessRange over_slices(std::span<const ProfileRoughness> wall);

// Runs the pass. `progress` is told the share done. Throws std::invalid_argument where the arm cannot follow the path
// or the pass cannot be simulated, std::runtime_error where the motion grows without bound.
HuynhPassResult run_huynh_pass(const HuynhPass& pass, const std::function<void(double)>& progress = {});

}  // namespace stillcut
