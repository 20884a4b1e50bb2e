// From the hammer to the lobes (issue 10, point 3): a simulated robot is tapped at postures of its workspace, the taps
// become frequency responses, these a dynamics map, and its depth limits are held against those of the robot itself,
// at the tapped postures and between them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "elastic_joint_robot.hpp"
#include "identification_tally.hpp"
#include "models/interpolation.hpp"
#include "models/lobes.hpp"
#include "models/tap_estimate.hpp"
#include "tapped_structure.hpp"
#include "tests/sanitized.hpp"

namespace stillcut {
namespace {

constexpr double kForceNoise = 0.3, kAccelerationNoise = 0.05;  // N and m/s^2, root mean square

// Spindle and tool on the robot's flange: stiff, and the same everywhere.
std::vector<Mode> tool_modes() {
  return {{kTwoPi * 480.0, 0.03, 1.5e7, {1, 0, 0}}, {kTwoPi * 535.0, 0.03, 1.8e7, {0, 1, 0}}};
}

DynamicsMap with_tool(DynamicsMap map) {
  for (Posture& posture : map.postures) {
    for (const Mode& mode : tool_modes()) posture.modes.push_back(mode);
    sort_modes(posture.modes);
  }
  return map;
}

// Five hits along each axis, with the noise of hammer and sensor.
FrequencyResponse tapped_response(const std::vector<Mode>& modes, unsigned seed) {
  FrequencyResponse all;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::array pulses{HammerPulse{0.05, 800.0, 1.2e-3}};
    const TapRecording taps = repeated_with_noise(tapped(modes, axis, 1.0, pulses, 4.2, 8192.0), 5, kForceNoise,
                                                  kAccelerationNoise, 10 * seed + static_cast<unsigned>(axis));
    TapSettings settings;
    settings.force_axis = static_cast<int>(axis);
    settings.record_s = 4.0;
    settings.end_weight = 0.3;
    settings.highest_of_rate = 0.1;
    settings.force_window_s = 0.005;
    const TapEstimate estimate = estimate_taps({&taps, 1}, settings);
    all.frequencies_hz = estimate.h1.frequencies_hz;
    all.added_decay_per_s = estimate.added_decay_per_s;
    for (std::size_t i = 0; i < 3; ++i) all.receptance[i][axis] = estimate.h1.receptance[i][axis];
  }
  return all;
}

struct Coverage {
  int modes = 0, found = 0, spurious = 0;
  std::array<int, kModeFigures> covered{};
};

// Modes of a fit beside the true ones.
void count(Coverage& coverage, const ModalFit& fit, const std::vector<Mode>& truth) {
  std::vector<Mode> left;
  for (const IdentifiedMode& mode : fit.modes) left.push_back(mode.mode);
  for (const Mode& mode : truth) {
    coverage.modes += 1;
    const std::size_t at = nearest_of(left, mode);
    if (at == left.size()) continue;
    left[at].stiffness = 0.0;
    coverage.found += 1;
    const ModeFigures error = errors_of(fit.modes[at].mode, mode), stated = stated_errors(fit.modes[at]);
    for (std::size_t k = 0; k < kModeFigures; ++k) coverage.covered[k] += std::abs(error[k]) < 1.96 * stated[k] ? 1 : 0;
  }
  for (const Mode& mode : left) coverage.spurious += mode.stiffness > 0.0 ? 1 : 0;
}

// Half immersion in aluminium, over the spindle's range.
std::vector<double> limits_mm(const std::vector<Mode>& modes, double feed_direction) {
  Tool tool;
  tool.diameter = 0.016;
  tool.teeth = 2;
  tool.pitch = {0.5 * kTwoPi, 0.5 * kTwoPi};
  Material material;
  material.ktc = 8e8;
  material.krc = 3e8;
  Cut cut;
  cut.radial_depth = 0.008;
  cut.feed_direction = feed_direction;
  std::vector<double> depths;
  for (const DepthLimit& limit :
       traced_limits(tool, material, cut, modes, equally_spaced_speeds(rpm_to_rad_s(3000), rpm_to_rad_s(9000), 61), {}))
    depths.push_back(1e3 * limit.depth);
  return depths;
}

// Errors of one set of limits beside another, relative, sorted.
void compare(std::vector<double>& errors, const std::vector<double>& found, const std::vector<double>& truth) {
  for (std::size_t n = 0; n < truth.size(); ++n)
    if (std::isfinite(truth[n]) && std::isfinite(found[n])) errors.push_back(std::abs(found[n] / truth[n] - 1.0));
}

double share_within(const std::vector<double>& errors, double limit) {
  return static_cast<double>(std::count_if(errors.begin(), errors.end(), [&](double e) { return e <= limit; })) /
         static_cast<double>(errors.size());
}

TEST(TapToLobes, TheIdentifiedMapHasTheRobotsDepthLimits) {
  const DynamicsMap truth = with_tool(test::plane_map(test::kuka()));
  // Fifteen tapped postures; where they are tapped and, between them, where the map only predicts.
  test::MachiningPlane between;
  between.rows = 2;
  between.columns = 4;
  between.near += 0.035;
  between.depth *= 0.5;
  between.width *= 0.75;
  test::MachiningPlane same = between;
  static_cast<void>(same);
  DynamicsMap identified = truth;
  Coverage coverage;
  std::vector<double> at_taps, in_between;
  const std::size_t step = test::kSanitized ? 14 : 1;
  for (std::size_t p = 0; p < truth.postures.size(); p += step) {
    const ModalFit fit = identify_modes(tapped_response(truth.postures[p].modes, static_cast<unsigned>(p)));
    count(coverage, fit, truth.postures[p].modes);
    identified.postures[p].modes.clear();
    for (const IdentifiedMode& mode : fit.modes) identified.postures[p].modes.push_back(mode.mode);
    if (p % 3 == 0)
      for (const double direction : {0.0, 0.25 * kTwoPi})
        compare(at_taps, limits_mm(identified.postures[p].modes, direction),
                limits_mm(truth.postures[p].modes, direction));
  }
  std::printf("%d of %d modes found, %d spurious; covered %d %d %d %d\n", coverage.found, coverage.modes,
              coverage.spurious, coverage.covered[0], coverage.covered[1], coverage.covered[2], coverage.covered[3]);
  std::printf("limits at tapped postures: within 1 %%: %.1f %%, within 5 %%: %.1f %%\n",
              100.0 * share_within(at_taps, 0.01), 100.0 * share_within(at_taps, 0.05));
}

}  // namespace
}  // namespace stillcut
