// A cutter on a tool path: times and angles, axes that turn, and what is refused.
#include "models/cutter_path.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/models/path_cuts.hpp"

namespace stillcut::test {
namespace {

TEST(CutterPath, TimeAndSpindleGoOnThroughRapids) {
  ToolPath path = straight_path({{0, 0, 0}, {1e-3, 0, 0}});
  path.moves.push_back({.from = {1e-3, 0, 0}, .to = {1e-3, 0, 50e-3}, .cutting = false});
  path.moves.back().spindle_speed = kTwoPi * 50.0;
  path.moves.push_back({.from = {1e-3, 0, 50e-3}, .to = {0, 0, 50e-3}, .cutting = false});
  path.moves.back().spindle_speed = 0.0;
  path.moves.push_back(path.moves.front());
  const CutterPath cutter = cutter_path(ball(), path, {.rapid_rate = 0.1, .angle = 1.0, .time = 5.0});
  ASSERT_EQ(cutter.pieces.size(), 4U);
  EXPECT_NEAR(cutter.pieces[0].duration, 1e-3 / kPathFeed, 1e-12);
  EXPECT_NEAR(cutter.pieces[1].time, 5.0 + 1e-3 / kPathFeed, 1e-12);
  EXPECT_NEAR(cutter.pieces[1].angle, 1.0 + 1e-3 / kPathFeed * kPathSpindle, 1e-9);
  EXPECT_NEAR(cutter.pieces[2].time - cutter.pieces[1].time, 0.5, 1e-12);
  EXPECT_NEAR(cutter.pieces[2].angle - cutter.pieces[1].angle, 0.5 * kTwoPi * 50.0, 1e-9);
  EXPECT_EQ(cutter.pieces[3].angle, cutter.pieces[2].angle);  // at rest
  EXPECT_TRUE(cutter.pieces[0].feeds && cutter.pieces[3].feeds);
  EXPECT_FALSE(cutter.pieces[1].feeds || cutter.pieces[2].feeds);
}

// The same point of the same edge as eq. 10 has it, its inclination and vibration included.
TEST(CutterPath, EdgesAreWhereThoseOfAPassAre) {
  SweptCut c;
  c.tool.runout = 20e-6;
  c.tool.axial_runout = 5e-6;
  c.tool.runout_angle = 0.4;
  c.tool.helix = 0.5;
  c.cut.tilt = 0.1;
  c.cut.lead = -0.2;
  c.displacement.at = [](double time) -> Eigen::Vector3d { return 1e-6 * Eigen::Vector3d(time, -2.0 * time, 3.0); };
  const CutterMotion motion = cutter_motion(c.tool, c.cut, c.displacement);
  const CutterPass pass{.begin = 1e-3, .length = 2e-3, .across = 0.5e-3, .angle = 0.3, .time = 7.0};
  const CutterPath cutter = path_of(c, motion, {pass});
  for (const double elapsed : {0.0, 0.01, 0.1}) {
    const EdgePoint point = ball_edge_point(c.tool, 0.3);
    EXPECT_LT(
        (edge_position(cutter, cutter.pieces[0], 1, point, elapsed) - edge_position(motion, pass, 1, point, elapsed))
            .norm(),
        1e-12);
  }
}

// Half way the axis stands half way, and the ball keeps its radius from the tip.
TEST(CutterPath, TheAxisTurnsEvenly) {
  ToolPath path = straight_path({{0, 0, 0}, {1e-3, 0, 0}, {2e-3, 0, 0}});
  path.moves[0].tool_axis = {0.6, 0.0, 0.8};
  path.moves[1].tool_axis = {0.0, 0.6, 0.8};
  const CutterPath cutter = cutter_path(ball(), path);
  EXPECT_EQ(cutter.pieces[0].axis_turn, 0.0);  // nothing is known of an axis before
  const BallPose pose = ball_pose(cutter, cutter.pieces[1], 0.5 * cutter.pieces[1].duration);
  const Eigen::Vector3d between = (path.moves[0].tool_axis + path.moves[1].tool_axis).normalized();
  EXPECT_LT((pose.orientation.col(2) - between).norm(), 1e-12);
  EXPECT_LT((pose.orientation * pose.orientation.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-12);
  EXPECT_LT((pose.centre - Eigen::Vector3d(1.5e-3, 0, 0) - 4e-3 * between).norm(), 1e-15);
  path.moves[1].axis_from = Eigen::Vector3d::UnitZ();
  EXPECT_LT((ball_pose(cutter_path(ball(), path), cutter_path(ball(), path).pieces[1], 0.0).orientation -
             Eigen::Matrix3d::Identity())
                .norm(),
            1e-12);
}

TEST(CutterPath, RefusesWithTheLine) {
  const auto refusal = [](auto spoil, PathConditions conditions = {}, Tool tool = ball()) -> std::string {
    ToolPath path = straight_path({{0, 0, 0}, {1e-3, 0, 0}, {2e-3, 0, 0}});
    path.moves[1].line = 17;
    spoil(path.moves[1]);
    try {
      (void)cutter_path(tool, path, conditions);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  const auto sound = [](PathMove&) {};
  EXPECT_EQ(refusal(sound), "");
  EXPECT_THAT(refusal([](PathMove& m) {
                m.tool_axis = {1, 0, 0};
              }),
              testing::HasSubstr("line 17: the tool's axis leans 90"));
  EXPECT_THAT(refusal([](PathMove& m) { m.tool_axis = {0, 0, -1}; }), testing::HasSubstr("leans 180"));
  EXPECT_THAT(refusal([](PathMove& m) { m.tool_axis = {0, 0, 2}; }), testing::HasSubstr("unit vector"));
  EXPECT_THAT(refusal([](PathMove& m) { m.feed_rate = kUnknown; }), testing::HasSubstr("line 17: its feed"));
  EXPECT_EQ(refusal([](PathMove& m) { m.feed_rate = kUnknown; }, {.feed_rate = 0.01}), "");
  EXPECT_THAT(refusal([](PathMove& m) { m.spindle_speed = kUnknown; }), testing::HasSubstr("line 17: its spindle"));
  EXPECT_EQ(refusal([](PathMove& m) { m.spindle_speed = kUnknown; }, {.spindle_speed = 600.0}), "");
  Tool end = ball();
  end.shape = ToolShape::end;
  EXPECT_THAT(refusal(sound, {}, end), testing::HasSubstr("shape = \"ball\""));
  EXPECT_THROW((void)cutter_path(ball(), {}), std::invalid_argument);
}

}  // namespace
}  // namespace stillcut::test
