// The vibration that a surface is milled with: none on a rigid structure, the same for the same seed, passes in the
// order of the milling kind.
#include "models/surface_vibration.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "models/milled_stock.hpp"
#include "models/surface_refinement.hpp"

namespace stillcut {
namespace {

VibrationSetup vibration_setup(double frequency_hz, double damping, double stiffness) {
  VibrationSetup setup;
  setup.tool = {.shape = ToolShape::ball,
                .diameter = 8e-3,
                .teeth = 2,
                .pitch = {0.5 * kTwoPi, 0.5 * kTwoPi},
                .helix = deg_to_rad(45),
                .runout = 5e-6};
  setup.material = {
      .name = "Al7075-T6", .ktc = 1661.8e6, .krc = 1240.8e6, .kac = 19.1e6, .kte = 7.1e3, .kre = 15.9e3, .kae = 2.3e3};
  setup.cut = {.radial_depth = 0.2e-3,
               .axial_depth = 0.3e-3,
               .feed_per_tooth = 0.05e-3,
               .spindle_speed = rpm_to_rad_s(6000),
               .tilt = deg_to_rad(5),
               .lead = deg_to_rad(10)};
  const double w = kTwoPi * frequency_hz;
  setup.modes = {
      {w, damping, stiffness, {1, 0, 0}}, {w, damping, stiffness, {0, 1, 0}}, {w, damping, stiffness, {0, 0, 1}}};
  return setup;
}

HeightMap surface_of(const VibrationSetup& setup) {
  const VibratingCutter cutter = vibrating_cutter(setup, 0.3e-3, 0.4e-3);
  HeightMap map = uncut_map(0.3e-3, 0.4e-3, 10e-6);
  sweep_all(SurfaceSweep(cutter.motion, setup.cut, map.spacing_along, map.spacing_across), map,
            cutter.vibration.passes);
  return map;
}

// Breaks with a displacement that belongs to another time or pass, or that is not the structure's.
TEST(SurfaceVibration, ARigidStructureLeavesTheSurfaceWithoutVibration) {
  const VibrationSetup setup = vibration_setup(500, 0.05, 1e13);
  const VibratingCutter cutter = vibrating_cutter(setup, 0.3e-3, 0.4e-3);
  EXPECT_LT(cutter.vibration.peak.norm(), 1e-11);
  HeightMap map = uncut_map(0.3e-3, 0.4e-3, 10e-6), still = map;
  sweep_all(SurfaceSweep(cutter.motion, setup.cut, map.spacing_along, map.spacing_across), map,
            cutter.vibration.passes);
  sweep_all(SurfaceSweep(cutter_motion(setup.tool, setup.cut), setup.cut, map.spacing_along, map.spacing_across), still,
            cutter.vibration.passes);
  for (std::size_t i = 0; i < map.heights.size(); ++i) EXPECT_NEAR(map.heights[i], still.heights[i], 1e-10);
}

// A steady cut bends the structure by its mean force, so that twice the stiffness halves it, whatever the mass.
TEST(SurfaceVibration, AStiffStructureBendsInProportion) {
  const Eigen::Vector3d soft = vibrating_cutter(vibration_setup(800, 0.1, 2e8), 0.5e-3, 0.2e-3).vibration.mean,
                        hard = vibrating_cutter(vibration_setup(800, 0.1, 4e8), 0.5e-3, 0.2e-3).vibration.mean;
  EXPECT_GT(soft.norm(), 1e-9);
  EXPECT_LT((soft - 2.0 * hard).norm(), 0.02 * soft.norm());
  EXPECT_GT(soft.z(), 0.0);  // a ball is lifted
}

TEST(SurfaceVibration, TheSameSeedGivesTheSameBitsAndAnotherDoesNot) {
  VibrationSetup setup = vibration_setup(250, 0.05, 5e6);
  setup.force_noise = 0.1;
  const HeightMap first = surface_of(setup), again = surface_of(setup);
  EXPECT_EQ(first.heights, again.heights);
  setup.seed = 2;
  EXPECT_NE(first.heights, surface_of(setup).heights);
}

// Stock stands at -y in down-milling, at +y in up-milling: passes go there, one after the other.
TEST(SurfaceVibration, PassesAreMilledTowardTheStock) {
  for (const Milling milling : {Milling::up, Milling::down}) {
    VibrationSetup setup = vibration_setup(300, 0.1, 1e8);
    setup.cut.milling = milling;
    const auto passes = vibrating_cutter(setup, 0.2e-3, 0.4e-3).vibration.passes;
    ASSERT_GT(passes.size(), 2U);
    for (std::size_t i = 1; i < passes.size(); ++i) {
      EXPECT_GT(passes[i].time, passes[i - 1].time);
      EXPECT_EQ(passes[i].across > passes[i - 1].across, milling == Milling::up);
    }
  }
}

// However much the tool vibrates, no pass is left out that could still cut: half as many more change nothing.
TEST(SurfaceVibration, NoPassIsMissing) {
  VibrationSetup setup = vibration_setup(250, 0.05, 3e6);
  setup.force_noise = 0.3;
  const VibratingCutter cutter = vibrating_cutter(setup, 0.2e-3, 0.2e-3);
  const auto needed = passes_over(cutter.motion, setup.cut, 0.2e-3, 0.2e-3);
  double low = 0.0, high = 0.0;
  for (const CutterPass& pass : cutter.vibration.passes) {
    low = std::min(low, pass.across), high = std::max(high, pass.across);
    EXPECT_GE(pass.length, needed.front().length);
  }
  for (const CutterPass& pass : needed) {
    EXPECT_GE(pass.across, low - 1e-12);
    EXPECT_LE(pass.across, high + 1e-12);
  }
}

TEST(SurfaceVibration, ZigZagAndEndMillsVibrateToo) {
  VibrationSetup setup = vibration_setup(300, 0.05, 5e6);
  setup.cut.path = PathKind::zigzag;
  const auto zigzag = vibrating_cutter(setup, 0.3e-3, 0.4e-3).vibration;
  EXPECT_TRUE(std::any_of(zigzag.passes.begin(), zigzag.passes.end(), [](const CutterPass& p) { return p.reversed; }));
  EXPECT_GT(zigzag.rms.norm(), 1e-8);
  setup.tool.shape = ToolShape::end;
  setup.cut.path = PathKind::unidirectional;
  setup.cut.radial_depth = 1e-3;
  setup.cut.tilt = setup.cut.lead = 0.0;
  const auto end_mill = vibrating_cutter(setup, 0.3e-3, 2e-3).vibration;
  EXPECT_GT(end_mill.rms.norm(), 1e-8);
}

TEST(SurfaceVibration, RefusesWhatCannotBeSimulated) {
  VibrationSetup setup = vibration_setup(300, 0.05, 5e6);
  EXPECT_THROW((void)vibrating_passes(setup, {}), std::invalid_argument);
  setup.modes.clear();
  EXPECT_THROW((void)vibrating_cutter(setup, 1e-3, 1e-3), std::invalid_argument);
}

// Before the first pass the stock is as its neighbours would have left it; a pass that begins has its ball's place.
TEST(MilledStock, IsTheGroovesOfThePassesBefore) {
  const VibrationSetup setup = vibration_setup(300, 0.05, 5e6);
  const std::vector<CutterPass> passes{{.length = 1e-3}, {.length = 1e-3, .across = -0.2e-3}};
  Stock stock = stock_for(setup.tool, setup.cut, passes);
  const auto height = [&](double x, double y) {
    const auto i = static_cast<std::size_t>(std::lround((x - stock.origin_x) / stock.map.spacing_along));
    const auto j = static_cast<std::size_t>(std::lround((y - stock.origin_y) / stock.map.spacing_across));
    return stock.map.at(i, j);
  };
  const auto arc = [](double away) { return 4e-3 - std::sqrt(16e-6 - away * away); };
  EXPECT_NEAR(height(0.5e-3, 0.2e-3), 0.0, 2e-8);          // the middle of the groove before
  EXPECT_NEAR(height(0.5e-3, 0.3e-3), arc(0.1e-3), 3e-7);  // its ridge
  EXPECT_NEAR(height(0.5e-3, -0.8e-3), arc(1e-3), 3e-6);   // toward the stock
  EXPECT_NEAR(height(0.5e-3, -1.5e-3), 0.3e-3, 1e-12);     // the stock itself
  cut_up_to_begin(setup.tool, passes[0], stock);
  EXPECT_LT(height(-0.2e-3, 0.0), 1e-12);
  EXPECT_NEAR(height(0.5e-3, -0.8e-3), arc(std::hypot(0.5e-3, 0.8e-3)), 1.2e-5);
}

}  // namespace
}  // namespace stillcut
