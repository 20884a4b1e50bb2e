// Where edges are: the formula's own points, runout, inclination, frames of the vibration, the order of passes.
#include "models/cutter_motion.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/models/swept_cuts.hpp"

namespace stillcut::test {
namespace {

TEST(CutterMotion, TeethTurnClockwiseFromTheCrossFeed) {
  const SweptCut c;
  const CutterMotion motion = cutter_motion(c.tool, c.cut);
  const double quarter = 0.25 * kTwoPi / motion.spindle_speed;
  const EdgePoint equator = ball_edge_point(c.tool, 0.25 * kTwoPi);
  CutterPass pass{.length = 1e-3};
  EXPECT_LT((edge_position(motion, pass, 0, equator, 0.0) - Eigen::Vector3d(0, 4e-3, 4e-3)).norm(), 1e-12);
  const Eigen::Vector3d turned(4e-3 + motion.feed_rate * quarter, 0.0, 4e-3);
  EXPECT_LT((edge_position(motion, pass, 0, equator, quarter) - turned).norm(), 1e-12);
  pass.reversed = true;
  const Eigen::Vector3d back(-4e-3 - motion.feed_rate * quarter, 0.0, 4e-3);
  EXPECT_LT((edge_position(motion, pass, 1, equator, quarter) - back).norm(), 1e-12);
}

TEST(CutterMotion, HelixLetsTheEdgeTrail) {
  SweptCut c;
  c.tool.helix = deg_to_rad(30);
  EXPECT_NEAR(ball_edge_point(c.tool, 0.25 * kTwoPi).lag, std::tan(c.tool.helix), 1e-12);  // psi_0 of eq. 3
  EXPECT_EQ(ball_edge_point(c.tool, 0.0).lag, 0.0);
  EXPECT_NEAR(wall_edge_point(c.tool, 4e-3).lag, std::tan(c.tool.helix), 1e-12);
}

// As MillingSimulation has it: rho cos(pitch angle - lambda) further out, the axial runout shared out alike, upward.
TEST(CutterMotion, RunoutIsSharedOutAsInMillingInTime) {
  SweptCut c;
  c.tool.teeth = 3;
  c.tool.pitch = {2.0, 2.2, kTwoPi - 4.2};
  c.tool.runout = 20e-6;
  c.tool.axial_runout = 5e-6;
  c.tool.runout_angle = 0.7;
  const CutterMotion motion = cutter_motion(c.tool, c.cut);
  const EdgePoint equator = ball_edge_point(c.tool, 0.25 * kTwoPi);
  const double angles[] = {0.0, 2.0, 4.2};
  for (std::size_t tooth = 0; tooth < 3; ++tooth) {
    const double share = std::cos(angles[tooth] - 0.7);
    for (const double time : {0.0, 1.3e-3, 4.1e-3}) {
      const Eigen::Vector3d at = edge_position(motion, {}, tooth, equator, time);
      const double out = (at.head<2>() - Eigen::Vector2d(motion.feed_rate * time, 0.0)).norm();
      EXPECT_NEAR(out, 4e-3 + 20e-6 * share, 1e-7);  // second order in the runout: rho^2 / 2R
      EXPECT_NEAR(at.z(), 4e-3 + 5e-6 * share, 1e-12);
    }
  }
}

TEST(CutterMotion, InclinationTurnsAboutXAfterYAfterTheToolsOwnAxis) {
  SweptCut c;
  c.cut.tilt = deg_to_rad(20);
  const Eigen::Vector3d tilted = cutter_motion(c.tool, c.cut).orientation.col(2);
  EXPECT_LT((tilted - Eigen::Vector3d(0, -std::sin(c.cut.tilt), std::cos(c.cut.tilt))).norm(), 1e-12);
  c.cut.lead = deg_to_rad(30);
  const CutterMotion motion = cutter_motion(c.tool, c.cut);
  EXPECT_NEAR(motion.inclination(), std::acos(std::cos(c.cut.tilt) * std::cos(c.cut.lead)), 1e-12);
  EXPECT_NEAR(motion.orientation(0, 2), std::sin(c.cut.lead), 1e-12);
  // The redundancy angle turns the tool about its axis: teeth come earlier or later, nothing else.
  c.cut.redundancy = 0.4;
  const CutterMotion redundant = cutter_motion(c.tool, c.cut);
  const EdgePoint point = ball_edge_point(c.tool, 0.5);
  EXPECT_LT((edge_position(redundant, {.angle = 0.4}, 0, point, 0.0) - edge_position(motion, {}, 0, point, 0.0)).norm(),
            1e-12);
}

// Vibration is in workpiece axes: neither the spindle nor the inclination turns it, the feed's direction does.
TEST(CutterMotion, VibrationComesAfterTheTurning) {
  SweptCut c;
  c.cut.feed_direction = deg_to_rad(90);
  c.cut.tilt = 0.3;
  const Eigen::Vector3f moved(3e-6F, 1e-6F, -2e-6F);
  c.displacement = sampled_displacement(1.0, 0.5, {Eigen::Vector3f::Zero(), moved});
  EXPECT_EQ(c.displacement.reach, moved.cast<double>().cwiseAbs());
  EXPECT_NEAR(c.displacement.speed, moved.norm() / 0.5, 1e-12);
  const CutterMotion still = cutter_motion(c.tool, c.cut), motion = cutter_motion(c.tool, c.cut, c.displacement);
  const EdgePoint point = ball_edge_point(c.tool, 0.3);
  for (const auto& [time, part] : {std::pair{0.0, 0.0}, {1.0, 0.0}, {1.25, 0.5}, {1.5, 1.0}, {9.0, 1.0}}) {
    const CutterPass pass{.time = time - 0.2};
    const Eigen::Vector3d off = edge_position(motion, pass, 0, point, 0.2) - edge_position(still, pass, 0, point, 0.2);
    EXPECT_LT((off - part * Eigen::Vector3d(1e-6, -3e-6, -2e-6)).norm(), 1e-12) << time;
  }
  EXPECT_THROW((void)sampled_displacement(0.0, 0.0, {moved}), std::invalid_argument);
  EXPECT_THROW((void)sampled_displacement(0.0, 1.0, {}), std::invalid_argument);
}

TEST(CutterMotion, PassesFollowEachOtherInTimeAndAngle) {
  SweptCut c;
  c.cut.path = PathKind::zigzag;
  const CutterMotion motion = cutter_motion(c.tool, c.cut);
  const auto passes = parallel_passes(motion, c.cut, 1e-3, 5e-3, -2e-3, 4, 0.123);
  for (std::size_t i = 0; i < passes.size(); ++i) {
    const CutterPass& pass = passes[i];
    EXPECT_EQ(pass.reversed, i % 2 == 1);
    EXPECT_NEAR(pass.begin, pass.reversed ? 6e-3 : 1e-3, 1e-15);
    EXPECT_NEAR(pass.across, -2e-3 + 0.4e-3 * static_cast<double>(i), 1e-15);
    EXPECT_NEAR(pass.time, static_cast<double>(i) * (5e-3 / motion.feed_rate + 0.123), 1e-12);
    EXPECT_NEAR(std::remainder(pass.angle - motion.spindle_speed * pass.time, kTwoPi), 0.0, 1e-9);
  }
}

}  // namespace
}  // namespace stillcut::test
