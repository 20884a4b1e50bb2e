#include "models/planned_path.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "dsp/numbers.hpp"
#include "models/machining.hpp"

namespace stillcut {
namespace {

const Region kPatchedPlate{{{0, 0}, {0.2, 0}, {0.2, 0.1}, {0, 0.1}}, {}};
const CuttingConditions kPatchConditions{2, 0.1e-3, 5e-3, 0.2};
const PatternSettings kPatchSettings{.tool_radius = 0.01, .step_over = 0.008};

PathPlan two_patches() {
  PathPlan plan;
  PlannedPatch left, right;
  left.x_begin = left.y_begin = right.y_begin = -kInfinity;
  left.x_end = right.x_begin = 0.12;
  left.y_end = right.x_end = right.y_end = kInfinity;
  left.direction = deg_to_rad(30.0);
  left.spindle_speed = 300.0;
  right.direction = deg_to_rad(110.0);
  right.spindle_speed = 400.0;
  plan.patches = {left, right};
  return plan;
}

double cutting_length(const ToolPath& path) {
  double length = 0.0;
  for (const PathMove& move : path.moves)
    if (move.cutting) length += (move.to - move.from).norm();
  return length;
}

TEST(PlannedPath, EachPatchHasItsDirectionSpeedAndFeedAndKeepsToItself) {
  const ToolPath path = planned_path(kPatchedPlate, two_patches(), kPatchSettings, kPatchConditions);
  int left = 0, right = 0;
  for (const PathMove& move : path.moves) {
    if (!move.cutting) continue;
    const bool first = move.spindle_speed == 300.0;
    ++(first ? left : right);
    const Eigen::Vector2d way = (move.to - move.from).head<2>();
    EXPECT_NEAR(std::remainder(std::atan2(way.y(), way.x()) - deg_to_rad(first ? 30.0 : 110.0), kTwoPi), 0.0, 1e-6);
    EXPECT_NEAR(move.feed_rate, 2 * 0.1e-3 * move.spindle_speed / kTwoPi, 1e-12);
    for (const double x : {move.from.x(), move.to.x()}) EXPECT_LE(first ? x : 0.12, (first ? 0.12 : x) + 1e-5);
  }
  EXPECT_GT(left, 8);
  EXPECT_GT(right, 5);
}

TEST(PlannedPath, MovesJoinAndEverythingIsCut) {
  const ToolPath path = planned_path(kPatchedPlate, two_patches(), kPatchSettings, kPatchConditions);
  for (std::size_t i = 1; i < path.moves.size(); ++i)
    EXPECT_LT((path.moves[i].from - path.moves[i - 1].to).norm(), 1e-12) << i;
  for (double x = 0.011; x < 0.19; x += 0.007) {
    for (double y = 0.011; y < 0.09; y += 0.007) {
      double nearest = kInfinity;
      for (const PathMove& move : path.moves) {
        if (!move.cutting) continue;
        const Eigen::Vector2d a = move.from.head<2>(), way = move.to.head<2>() - a, point(x, y);
        const double share = std::clamp((point - a).dot(way) / way.squaredNorm(), 0.0, 1.0);
        nearest = std::min(nearest, (a + share * way - point).norm());
      }
      EXPECT_LT(nearest, kPatchSettings.tool_radius) << x << ", " << y;
    }
  }
}

TEST(PlannedPath, APatchBesideTheRegionHasNoMoves) {
  PathPlan plan = two_patches();
  plan.patches[1].x_begin = 0.25;
  const ToolPath path = planned_path(kPatchedPlate, plan, kPatchSettings, kPatchConditions);
  for (const PathMove& move : path.moves) EXPECT_EQ(move.spindle_speed == 400.0, false);
  EXPECT_FALSE(path.moves.empty());
}

TEST(PlannedPath, LayersGoDownEquallyToTheDepth) {
  const ToolPath once = planned_path(kPatchedPlate, two_patches(), kPatchSettings, kPatchConditions);
  const ToolPath layers = in_layers(once, 2.5e-3, 1e-3, 5e-3);
  EXPECT_NEAR(cutting_length(layers), 3.0 * cutting_length(once), 1e-9);
  double lowest = 0.0;
  for (std::size_t i = 0; i < layers.moves.size(); ++i) {
    const PathMove& move = layers.moves[i];
    if (i > 0) {
      EXPECT_LT((move.from - layers.moves[i - 1].to).norm(), 1e-12) << i;
    }
    if (move.cutting) {
      EXPECT_EQ(move.from.z(), move.to.z());
      EXPECT_NEAR(std::remainder(move.to.z(), 2.5e-3 / 3.0), 0.0, 1e-12);
      EXPECT_LE(move.to.z(), lowest);
      lowest = move.to.z();
    } else if ((move.to - move.from).head<2>().norm() > 0.0) {
      EXPECT_EQ(move.to.z(), 5e-3) << "across only above the part";
    }
  }
  EXPECT_NEAR(lowest, -2.5e-3, 1e-12);
  EXPECT_THROW(in_layers(once, 0.0, 1e-3, 5e-3), std::invalid_argument);
  EXPECT_THROW(in_layers(once, 1.0, 1e-5, 5e-3), std::invalid_argument);
}

}  // namespace
}  // namespace stillcut
