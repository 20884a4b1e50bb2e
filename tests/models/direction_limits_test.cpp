#include "models/direction_limits.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>

#include "dsp/numbers.hpp"
#include "models/lobes.hpp"
#include "models/paper_projection.hpp"
#include "models/receptance.hpp"
#include "models/zeroth_order.hpp"
#include "stability_cases.hpp"

namespace stillcut {
namespace {

using test::mode_of, test::RobotCell;

// A soft structure and a tool, each along a direction of its own.
std::vector<Mode> random_structure(std::mt19937& random) {
  std::uniform_real_distribution<double> share(0.0, 1.0);
  const double first = 3.1 * share(random), second = 3.1 * share(random);
  return {mode_of(50 + 20 * share(random), 0.04, 4e6, std::cos(first), std::sin(first)),
          mode_of(110 + 20 * share(random), 0.04, 6e6, std::cos(second), std::sin(second)),
          mode_of(480 + 40 * share(random), 0.03, 9e6, std::cos(first), std::sin(first)),
          mode_of(490 + 40 * share(random), 0.03, 9e6 * (1 + share(random)), -std::sin(first), std::cos(first))};
}

DirectionStudy study_of(const RobotCell& cell, DirectionMethod method, std::vector<double> directions) {
  DirectionStudy study;
  study.directions = std::move(directions);
  study.speeds = equally_spaced_speeds(cell.spindle.min_speed, cell.spindle.max_speed, 41);
  study.method = method;
  study.max_depth = 0.03;
  return study;
}

std::vector<DirectionCurve> limits_of(const RobotCell& cell, const std::vector<Mode>& modes,
                                      const DirectionStudy& study) {
  return limits_over_direction(cell.tool, cell.material, cell.cut, modes, study);
}

void expect_near(const std::vector<double>& a, const std::vector<double>& b, double relative) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (std::isinf(b[i])) {
      EXPECT_EQ(a[i], b[i]) << i;
    } else {
      EXPECT_NEAR(a[i], b[i], relative * b[i]) << i;
    }
  }
}

TEST(DirectionLimits, TurningTheFeedIsTurningTheStructureBack) {
  std::mt19937 random{7};
  const RobotCell cell;
  for (const DirectionMethod method : {DirectionMethod::floquet, DirectionMethod::zeroth_order}) {
    for (int i = 0; i < 3; ++i) {
      const std::vector<Mode> modes = random_structure(random);
      const double direction = std::uniform_real_distribution<double>(0.0, kTwoPi)(random);
      const auto turned = limits_of(cell, modes, study_of(cell, method, {direction}));
      const auto straight = limits_of(cell, modes_in_feed_frame(modes, direction), study_of(cell, method, {0.0}));
      expect_near(turned.front().limits, straight.front().limits, 1e-9);
    }
  }
}

TEST(DirectionLimits, AreThoseOfTheLobesThatAreSearchedSpeedBySpeed) {
  std::mt19937 random{8};
  RobotCell cell;
  const std::vector<Mode> modes = random_structure(random);
  const DirectionStudy study = study_of(cell, DirectionMethod::floquet, {0.4});
  const auto curves = limits_of(cell, modes, study);
  cell.cut.feed_direction = 0.4;
  LobeSettings settings;
  settings.max_depth = study.max_depth;
  std::vector<double> searched;
  for (const DepthLimit& limit : depth_limits(cell.tool, cell.material, cell.cut, modes, study.speeds, settings))
    searched.push_back(limit.depth);
  expect_near(curves.front().limits, searched, 2e-3);
}

TEST(DirectionLimits, OppositeDirectionsHaveTheSameAndAreNotMixedUp) {
  std::mt19937 random{9};
  const RobotCell cell;
  const std::vector<Mode> modes = random_structure(random);
  const double pi = std::numbers::pi;
  const auto together = limits_of(cell, modes, study_of(cell, DirectionMethod::zeroth_order, {0.3, 1.4, 0.3 + pi}));
  const auto alone = limits_of(cell, modes, study_of(cell, DirectionMethod::zeroth_order, {0.3 + pi}));
  EXPECT_EQ(together[2].limits, together[0].limits);
  EXPECT_NE(together[2].limits, together[1].limits);
  expect_near(alone[0].limits, together[0].limits, 1e-9);
}

TEST(DirectionLimits, OfAnIsotropicStructureAreTheSameAllAround) {
  const RobotCell cell;
  const std::vector<Mode> modes{mode_of(500, 0.03, 1e7, 1, 0), mode_of(500, 0.03, 1e7, 0, 1)};
  const auto curves = limits_of(cell, modes, study_of(cell, DirectionMethod::floquet, {0.0, 0.6, 1.9}));
  expect_near(curves[1].limits, curves[0].limits, 1e-6);
  expect_near(curves[2].limits, curves[0].limits, 1e-6);
}

TEST(DirectionLimits, ToAndFroIsTheLowerOfBothSenses) {
  std::mt19937 random{10};
  RobotCell cell;
  const std::vector<Mode> modes = random_structure(random);
  DirectionStudy study = study_of(cell, DirectionMethod::zeroth_order, {0.8});
  const auto down = limits_of(cell, modes, study);
  cell.cut.milling = Milling::up;
  const auto up = limits_of(cell, modes, study);
  study.sense = CutSense::alternating;
  const auto both = limits_of(cell, modes, study);
  for (std::size_t i = 0; i < study.speeds.size(); ++i)
    EXPECT_EQ(both[0].limits[i], std::min(down[0].limits[i], up[0].limits[i]));
  EXPECT_NE(down[0].limits, up[0].limits);
}

TEST(DirectionLimits, ThePapersProjectionAgreesAlongXAndTurnsAStructureAgainstTheForceAlongY) {
  const RobotCell cell;
  const std::vector<Mode> modes{mode_of(490, 0.03, 8e6, 1, 0), mode_of(510, 0.03, 1.6e7, 0, 1)};
  const auto paper = limits_of(cell, modes, study_of(cell, DirectionMethod::paper, {0.0, deg_to_rad(90)}));
  const auto tensor = limits_of(cell, modes, study_of(cell, DirectionMethod::zeroth_order, {0.0, deg_to_rad(90)}));
  expect_near(paper[0].limits, tensor[0].limits, 1e-9);
  const LinearCut cut = linear_cut(cell.tool, cell.material, cell.cut);
  const auto by_hand = [&](double frequency) {
    const Eigen::Matrix3cd g = receptance(modes, frequency);
    Eigen::Matrix2cd turned = Eigen::Matrix2cd::Zero();
    turned(0, 0) = g(1, 1);
    turned(1, 1) = -g(0, 0);
    return turned;
  };
  const DirectionStudy study = study_of(cell, DirectionMethod::paper, {});
  std::vector<double> expected;
  for (const DepthLimit& limit : zeroth_order_limits(cut, modes, by_hand, study.speeds, study.max_depth))
    expected.push_back(limit.depth);
  expect_near(paper[1].limits, expected, 1e-6);
  EXPECT_NE(paper[1].limits, tensor[1].limits);
}

TEST(DirectionLimits, AbsoluteLimitAndPocketAreTheLowestAndTheHighest) {
  const std::vector<double> speeds{100, 110, 120, 130, 140, 150};
  const std::vector<double> limits{1.0, 3.0, 2.0, 3.0, 3.0, 3.0};
  EXPECT_EQ(absolute_limit(limits), 1.0);
  EXPECT_EQ(deepest_pocket(limits, speeds).depth, 3.0);
  EXPECT_EQ(deepest_pocket(limits, speeds).speed, 140.0);  // the middle of the widest run
  const std::vector<double> without{0.0, kInfinity, 1.0, 1.0, 1.0, 1.0};
  EXPECT_EQ(absolute_limit(without), 0.0);
  EXPECT_EQ(deepest_pocket(without, speeds).speed, 110.0);
}

TEST(DirectionLimits, DirectionsGoAroundOnce) {
  EXPECT_EQ(directions_around(deg_to_rad(10)).size(), 36U);
  EXPECT_EQ(directions_around(deg_to_rad(180)).size(), 2U);
  EXPECT_EQ(directions_around(deg_to_rad(7)).size(), 52U);
  EXPECT_LT(directions_around(deg_to_rad(7)).back(), kTwoPi);
  for (const double step : {0.0, -1.0, 4.0, std::nan("")})
    EXPECT_THROW((void)directions_around(step), std::invalid_argument);
  EXPECT_THROW((void)absolute_limit({}), std::invalid_argument);
  EXPECT_THROW((void)deepest_pocket(std::vector<double>{1.0}, std::vector<double>{}), std::invalid_argument);
}

}  // namespace
}  // namespace stillcut
