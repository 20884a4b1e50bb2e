#include "models/lobes.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "dsp/numbers.hpp"
#include "stability_cases.hpp"

namespace stillcut {
namespace {

using test::RobotCell;

LobeDiagram four_points() {
  LobeDiagram diagram;
  diagram.valid = true;
  diagram.point_count = 4;
  diagram.points[0] = {100, 1e-3, 50};
  diagram.points[1] = {110, 2e-3, 50};
  diagram.points[2] = {120, kInfinity, kNaN};
  diagram.points[3] = {130, kNaN, kNaN};
  return diagram;
}

TEST(LobeDiagram, LooksUpTheSmallerNeighbour) {
  const LobeDiagram diagram = four_points();
  EXPECT_DOUBLE_EQ(depth_limit_at(diagram, 100), 1e-3);
  EXPECT_DOUBLE_EQ(depth_limit_at(diagram, 104), 1e-3);
  EXPECT_DOUBLE_EQ(depth_limit_at(diagram, 110), 2e-3);
  EXPECT_DOUBLE_EQ(depth_limit_at(diagram, 115), 2e-3);
  EXPECT_EQ(depth_limit_at(diagram, 120), kInfinity);
  EXPECT_EQ(depth_limit_at(diagram, 125), 0.0);
  EXPECT_EQ(depth_limit_at(diagram, 130), 0.0);
}

TEST(LobeDiagram, KnowsNothingOutsideItsRange) {
  LobeDiagram diagram = four_points();
  EXPECT_TRUE(std::isnan(depth_limit_at(diagram, 99)));
  EXPECT_TRUE(std::isnan(depth_limit_at(diagram, 131)));
  EXPECT_TRUE(std::isnan(depth_limit_at(diagram, kNaN)));
  EXPECT_TRUE(std::isnan(depth_limit_at(LobeDiagram{}, 110)));
  diagram.valid = false;
  EXPECT_TRUE(std::isnan(depth_limit_at(diagram, 110)));
}

TEST(LobeDiagram, MarginIsLimitOverDepthMinusOne) {
  const LobeDiagram diagram = four_points();
  EXPECT_DOUBLE_EQ(margin_at(diagram, 110, 1e-3), 1.0);
  EXPECT_DOUBLE_EQ(margin_at(diagram, 110, 4e-3), -0.5);
  EXPECT_EQ(margin_at(diagram, 120, 1e-3), kInfinity);
  EXPECT_EQ(margin_at(diagram, 130, 1e-3), -1.0);
  EXPECT_TRUE(std::isnan(margin_at(diagram, 110, 0.0)));
  EXPECT_TRUE(std::isnan(margin_at(diagram, 110, kNaN)));
}

TEST(Lobes, DiagramCoversTheSpindlesRangeAndNamesTheModes) {
  const RobotCell cell;
  const LobeDiagram diagram =
      compute_lobe_diagram(cell.tool, cell.material, cell.cut, cell.spindle, test::robot_modes(), {.points = 21});
  EXPECT_TRUE(diagram.valid);
  ASSERT_EQ(diagram.point_count, 21);
  EXPECT_DOUBLE_EQ(diagram.points[0].speed, cell.spindle.min_speed);
  EXPECT_DOUBLE_EQ(diagram.points[20].speed, cell.spindle.max_speed);
  ASSERT_EQ(diagram.mode_count, 4);
  EXPECT_DOUBLE_EQ(diagram.modes[0].frequency_hz, 55.0);
  EXPECT_DOUBLE_EQ(diagram.modes[3].frequency_hz, 520.0);
  for (int i = 0; i < 21; ++i) {
    const LobePoint& point = diagram.points[static_cast<std::size_t>(i)];
    EXPECT_GT(point.depth_limit, 0.0);
    EXPECT_EQ(std::isfinite(point.depth_limit), std::isfinite(point.chatter_frequency_hz));
    EXPECT_DOUBLE_EQ(depth_limit_at(diagram, point.speed), point.depth_limit);
  }
}

TEST(Lobes, TurningFeedAndStructureTogetherChangesNothing) {
  const RobotCell cell;
  const auto speeds = equally_spaced_speeds(cell.spindle.min_speed, cell.spindle.max_speed, 5);
  const auto plain = depth_limits(cell.tool, cell.material, cell.cut, test::robot_modes(), speeds, {});
  Cut turned = cell.cut;
  turned.feed_direction = 0.7;
  const auto modes = modes_in_feed_frame(test::robot_modes(), -0.7);
  const auto other = depth_limits(cell.tool, cell.material, turned, modes, speeds, {});
  for (std::size_t i = 0; i < speeds.size(); ++i) EXPECT_NEAR(other[i].depth, plain[i].depth, 1e-6 * plain[i].depth);
}

TEST(Lobes, TheSummaryOfManyModesKeepsTheMostCompliant) {
  const RobotCell cell;
  std::vector<Mode> modes;
  for (int i = 0; i < 30; ++i) modes.push_back(test::mode_of(100 + 20 * i, 0.03, i < 10 ? 1e9 : 1e8, 1, 0));
  const LobeDiagram diagram = compute_lobe_diagram(cell.tool, cell.material, cell.cut, cell.spindle, modes,
                                                   {.method = LobeMethod::zeroth_order, .points = 2});
  ASSERT_EQ(diagram.mode_count, LobeDiagram::kMaxModes);
  EXPECT_NEAR(diagram.modes[0].frequency_hz, 300.0, 1e-9);
}

TEST(Lobes, RefusesMoreModesThanTheFloquetSolutionTakes) {
  const RobotCell cell;
  const std::vector<Mode> modes(kMostFloquetModes + 1, test::mode_of(100, 0.03, 1e9, 1, 0));
  const double speeds[] = {300.0};
  EXPECT_THROW(depth_limits(cell.tool, cell.material, cell.cut, modes, speeds, {}), std::invalid_argument);
  EXPECT_NO_THROW(
      depth_limits(cell.tool, cell.material, cell.cut, modes, speeds, {.method = LobeMethod::zeroth_order}));
}

TEST(Lobes, SpeedsIncludeBothEnds) {
  const auto speeds = equally_spaced_speeds(100.0, 200.0, 7);
  EXPECT_EQ(speeds.size(), 7u);
  EXPECT_EQ(speeds.front(), 100.0);
  EXPECT_EQ(speeds.back(), 200.0);
  EXPECT_EQ(equally_spaced_speeds(100.0, 200.0, 1), std::vector<double>{100.0});
  EXPECT_EQ(equally_spaced_speeds(100.0, 100.0, 1), std::vector<double>{100.0});
  EXPECT_THROW(equally_spaced_speeds(0.0, 200.0, 3), std::invalid_argument);
  EXPECT_THROW(equally_spaced_speeds(200.0, 100.0, 3), std::invalid_argument);
  EXPECT_THROW(equally_spaced_speeds(100.0, 200.0, 0), std::invalid_argument);
}

TEST(Lobes, RefusesADiagramWithoutRoom) {
  const RobotCell cell;
  for (const int points : {1, LobeDiagram::kMaxPoints + 1}) {
    EXPECT_THROW(
        compute_lobe_diagram(cell.tool, cell.material, cell.cut, cell.spindle, test::robot_modes(), {.points = points}),
        std::invalid_argument);
  }
}

}  // namespace
}  // namespace stillcut
