// Milling in a part: against the closed form of a slot, against the simulation that keeps its surface about the axis,
// and the wall that is left.
#include "models/part_milling.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "models/surface_roughness.hpp"
#include "models/wall_profile.hpp"
#include "tests/sanitized.hpp"

namespace stillcut {
namespace {

constexpr double kPartSpeed = rpm_to_rad_s(6000);  // rad/s

Material part_material() {
  return {.name = "", .ktc = 800e6, .krc = 300e6, .kac = 100e6, .kte = 12e3, .kre = 9e3, .kae = 2e3};
}

// Along x from the origin, in the midst of a cut at the start: the part has the tool's own shape in front of it.
PartMillingSetup straight_pass(Tool tool, double depth, Milling milling, double radial_depth, double feed_per_tooth) {
  constexpr double kBack = -2e-3, kEnd = 8e-3;
  PartMillingSetup setup;
  const double radius = 0.5 * tool.diameter, far = radius + 2e-3;
  const auto [entry, exit] = immersion(milling, radial_depth, tool.diameter);
  Contour front;
  for (int i = 0; i <= 400; ++i) {
    const double phi = entry + (exit - entry) * i / 400.0;
    front.emplace_back(radius * std::sin(phi), radius * std::cos(phi));
  }
  Contour part;
  if (milling == Milling::up || milling == Milling::slot)
    part = {{kEnd, front.back().y()}, {kEnd, far}, {kBack, far}, {kBack, radius}};
  if (milling == Milling::slot) part.erase(part.begin());
  part.insert(part.end(), front.begin(), front.end());
  if (milling != Milling::up) part.insert(part.end(), {{kBack, -radius}, {kBack, -far}, {kEnd, -far}});
  part.emplace_back(kEnd, milling == Milling::slot ? far : front[milling == Milling::up ? 400 : 0].y());
  setup.part = {part};
  const double feed = feed_per_tooth * tool.teeth * kPartSpeed / kTwoPi;
  setup.path = [feed](double time) { return Eigen::Vector2d(feed * time, 0.0); };
  setup.tool = std::move(tool);
  setup.material = part_material();
  setup.axial_depth = depth;
  setup.spindle_speed = kPartSpeed;
  return setup;
}

std::vector<Mode> part_modes(double stiffness) {
  return {{kTwoPi * 400, 0.05, stiffness, {1, 0, 0}},
          {kTwoPi * 430, 0.05, stiffness, {0, 1, 0}},
          {kTwoPi * 410, 0.05, stiffness, {0, 0, 1}}};
}

Tool part_tool(int teeth, double diameter) {
  Tool tool;
  tool.teeth = teeth;
  tool.diameter = diameter;
  tool.pitch.assign(static_cast<std::size_t>(teeth), kTwoPi / teeth);
  return tool;
}

auto modal(const std::vector<Mode>& modes) {
  return [modes](double step) { return std::make_unique<ModalStructure>(modes, step); };
}

TEST(PartMilling, MeanSlottingForceIsTheClosedForm) {
  constexpr double kFeed = 0.05e-3;
  constexpr int kTurns = 8;
  for (const int teeth : {1, 3}) {
    PartMillingSetup setup = straight_pass(part_tool(teeth, 6e-3), 1.5e-3, Milling::slot, 6e-3, kFeed);
    setup.structure = modal(part_modes(1e12));
    constexpr int kSteps = 360;
    setup.steps_per_turn = kSteps;
    PartMilling cut(setup);
    for (int i = 0; i < 2 * kSteps; ++i) cut.advance();
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    const int steps = kTurns * kSteps;
    for (int i = 0; i < steps; ++i) mean += cut.advance().force / steps;
    const Material m = setup.material;
    const double n = teeth, depth = setup.axial_depth;
    const Eigen::Vector3d expected(-n * depth * (m.krc * kFeed / 4 + m.kre / std::numbers::pi),
                                   n * depth * (m.ktc * kFeed / 4 + m.kte / std::numbers::pi),
                                   -n * depth * (m.kac * kFeed / std::numbers::pi + m.kae / 2));
    EXPECT_LT((mean - expected).norm(), 0.01 * expected.norm()) << teeth << " teeth: " << mean.transpose();
  }
}

// Both see the same cut; one keeps the part, the other the surface about the axis, whose chip f sin phi leaves out
// f^2 cos^2 phi / 2R (here 0.5 % of the feed) and what a tooth cuts of the cusps beyond the wall's foot.
TEST(PartMilling, AgreesWithTheSurfaceAboutTheAxisOnAStraightPass) {
  Tool tool = part_tool(2, 6e-3);
  tool.pitch = {deg_to_rad(170), deg_to_rad(190)};
  tool.helix = deg_to_rad(30);
  tool.runout = 4e-6;
  tool.runout_angle = 0.4;
  constexpr double kFeed = 0.03e-3;
  constexpr int kSteps = 360;
  for (const auto& [milling, edges] : {std::pair{Milling::down, true}, {Milling::up, true}, {Milling::down, false}}) {
    PartMillingSetup setup = straight_pass(tool, 1.0e-3, milling, 2.5e-3, kFeed);
    if (!edges) setup.material.kte = setup.material.kre = setup.material.kae = 0.0;
    setup.structure = modal(part_modes(3e7));
    setup.steps_per_turn = kSteps;
    setup.discs = 6;
    setup.chords = 4;
    MillingSetup about_axis;
    about_axis.tool = tool;
    about_axis.material = setup.material;
    about_axis.cut = {.milling = milling,
                      .radial_depth = 2.5e-3,
                      .axial_depth = 1.0e-3,
                      .feed_per_tooth = kFeed,
                      .spindle_speed = kPartSpeed};
    about_axis.modes = part_modes(3e7);
    PartMilling part(setup);
    MillingSimulation axis(about_axis, kSteps * kPartSpeed / kTwoPi);
    double difference = 0.0, size = 0.0, peak = 0.0, peak_part = 0.0;
    Eigen::Vector3d mean = Eigen::Vector3d::Zero(), mean_part = mean, before = mean;
    for (int i = 0; i < 12 * kSteps; ++i) {
      const Eigen::Vector3d of_part = part.advance().force, of_axis = axis.advance().force;
      if (i >= 6 * kSteps) {
        mean += of_axis;
        mean_part += of_part;
        difference += (0.5 * (before + of_part) - of_axis).squaredNorm();
        size += of_axis.squaredNorm();
        peak = std::max(peak, of_axis.norm());
        peak_part = std::max(peak_part, of_part.norm());
      }
      before = of_part;
    }
    EXPECT_LT((mean - mean_part).norm(), 0.01 * mean.norm()) << static_cast<int>(milling);
    EXPECT_NEAR(peak, peak_part, 0.01 * peak) << static_cast<int>(milling);
    EXPECT_LT(std::sqrt(difference / size), 0.03) << static_cast<int>(milling);
    EXPECT_LT((axis.state().displacement - part.state().displacement).norm(), 0.02 * axis.state().displacement.norm());
    if (test::kSanitized) return;
  }
}

// Two equal teeth without vibration leave cusps of f^2/8R, f the feed per tooth; the chords add their sagitta.
TEST(PartMilling, LeavesTheCuspsOfItsFeedOnTheWall) {
  constexpr double kFeed = 0.1e-3;
  PartMillingSetup setup = straight_pass(part_tool(2, 4e-3), 0.5e-3, Milling::down, 0.5e-3, kFeed);
  setup.structure = modal(part_modes(1e13));
  setup.chords = 16;
  setup.discs = 1;
  PartMilling cut(setup);
  for (int i = 0; i < 25 * 100; ++i) cut.advance();
  WallLine line;
  line.start = {0.5e-3, -2e-3 + 0.2e-3};
  line.into = {0, -1};
  line.length = 2e-3;
  const std::vector<double> heights = wall_profile(cut.slices()[0], line);
  const double cusp = kFeed * kFeed / (8 * 2e-3);
  const ProfileRoughness wall = profile_roughness(heights, line.spacing);
  EXPECT_NEAR(wall.rt, cusp, 0.1 * cusp);
  EXPECT_NEAR(wall.ra, cusp * 2 / (9 * std::sqrt(3.0)) * 2, 0.1 * wall.ra);  // of parabolas: 0.2566 of their height
  const double mean = std::accumulate(heights.begin(), heights.end(), 0.0) / static_cast<double>(heights.size());
  EXPECT_NEAR(mean, 0.2e-3 - cusp / 3, 0.1 * cusp);
}

TEST(PartMilling, CutsNothingWhereNothingIsLeft) {
  PartMillingSetup setup = straight_pass(part_tool(2, 4e-3), 0.5e-3, Milling::down, 0.5e-3, 0.1e-3);
  setup.structure = modal(part_modes(1e13));
  setup.part = {{{0, -5e-3}, {1e-3, -5e-3}, {1e-3, -1.5e-3}, {0, -1.5e-3}}};  // ends after 1 mm
  PartMilling cut(setup);
  double largest = 0.0;
  for (int i = 0; i < 15 * 100; ++i) largest = std::max(largest, cut.advance().force.norm());
  EXPECT_GT(largest, 1.0);
  for (int i = 0; i < 5 * 100; ++i) {
    EXPECT_EQ(cut.advance().force.norm(), 0.0);
    EXPECT_EQ(cut.state().chip, 0.0);
  }
}

TEST(PartMilling, RefusesWhatItCannotSimulate) {
  PartMillingSetup good = straight_pass(part_tool(2, 4e-3), 0.5e-3, Milling::down, 0.5e-3, 0.1e-3);
  good.structure = modal(part_modes(1e7));
  EXPECT_NO_THROW(PartMilling{good});
  const auto refuses = [&](auto change) {
    PartMillingSetup setup = good;
    change(setup);
    EXPECT_THROW(PartMilling{setup}, std::invalid_argument);
  };
  refuses([](PartMillingSetup& s) { s.tool.shape = ToolShape::ball; });
  refuses([](PartMillingSetup& s) { s.tool.pitch.pop_back(); });
  refuses([](PartMillingSetup& s) { s.axial_depth = 0.0; });
  refuses([](PartMillingSetup& s) { s.spindle_speed = std::nan(""); });
  refuses([](PartMillingSetup& s) { s.steps_per_turn = 29.0; });
  refuses([](PartMillingSetup& s) { s.structure = {}; });
  refuses([](PartMillingSetup& s) { s.part.clear(); });
}

TEST(WallProfile, IsHowFarAwayTheWallStands) {
  const PartSlice plate(std::vector<Contour>{{{0, 0}, {1e-3, 0}, {1e-3, 1e-3}, {0, 1e-3}}});
  WallLine line;
  line.start = {0.1e-3, 2e-3};
  line.into = {0, -1};
  line.length = 0.5e-3;
  line.reach = 1.5e-3;
  for (const double height : wall_profile(plate, line)) EXPECT_NEAR(height, 1e-3, 1e-9);
  line.length = 4e-3;
  EXPECT_THROW(wall_profile(plate, line), std::runtime_error);
}

}  // namespace
}  // namespace stillcut
