// How the tool vibrates over the passes that leave a surface (Liu et al. 2024, section 2.2): each pass is milled in
// time after the one before, on what that left, so that forces, waves and what the next pass meets belong together.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <vector>

#include "models/cutter_motion.hpp"
#include "models/dynamics_map.hpp"

namespace stillcut {

struct VibrationSetup {
  Tool tool;
  Material material;
  Cut cut;
  std::vector<Mode> modes;                 // in workpiece axes
  double force_noise = 0.0;                // rms of the chip formation's own variation, relative to the force
  std::uint64_t seed = 1;                  // of that noise
  std::function<void(double)> progress{};  // share that is done, 0..1
};

struct SurfaceVibration {
  std::vector<CutterPass> passes;  // with the spindle angle at which each was milled, and its time in `displacement`
  Displacement displacement;       // of these passes, their run-ins left out, workpiece axes
  Eigen::Vector3d mean = Eigen::Vector3d::Zero(), rms = mean, peak = mean;  // m, over the passes; rms about the mean
};

// Mills these passes. A ball end (models/surface_milling) takes them in the order that leaves uncut stock on the side
// the milling kind asks for, a slot as up-milling does: its passes lie side by side; an end mill
// (models/milling_simulation) in the given one, upright and in a cut that does not end: its tilt and lead do not change
// its force. Each pass has a run-in, in which the structure settles. Throws std::invalid_argument, in words for the
// user, for what cannot be simulated, std::runtime_error where the motion cannot be continued.
[[nodiscard]] SurfaceVibration vibrating_passes(const VibrationSetup& setup, std::vector<CutterPass> passes);

// The cutter as it vibrates, and so many passes that none is missing over 0 to `along`, 0 to `across` (m): how far away
// a pass still matters depends on how much the tool vibrates. Throws as vibrating_passes() does.
struct VibratingCutter {
  CutterMotion motion;
  SurfaceVibration vibration;
};
[[nodiscard]] VibratingCutter vibrating_cutter(const VibrationSetup& setup, double along, double across);

}  // namespace stillcut
