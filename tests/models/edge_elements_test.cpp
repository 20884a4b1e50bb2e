#include "models/edge_elements.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace stillcut {
namespace {

using std::numbers::pi;

Tool cutter(ToolShape shape, double helix_deg) {
  Tool tool;
  tool.shape = shape;
  tool.diameter = 0.01;
  tool.teeth = 2;
  tool.pitch = {pi, pi};
  tool.helix = deg_to_rad(helix_deg);
  return tool;
}

struct Sums {
  double height = 0.0, length = 0.0, top_lag = 0.0, facing_down = 0.0;
};

Sums summed(const Tool& tool, double depth, int count) {
  Sums sums;
  for (const EdgeElement& piece : edge_elements(tool, depth, count)) {
    EXPECT_NEAR(std::hypot(piece.sin_kappa, piece.cos_kappa), 1.0, 1e-12);
    EXPECT_GT(piece.lag, sums.top_lag - 1e-15);  // rising from the tip
    sums.height += piece.chip_width * piece.sin_kappa;
    sums.length += piece.edge_length;
    sums.facing_down += piece.chip_width * piece.cos_kappa;
    sums.top_lag = piece.lag;
  }
  return sums;
}

TEST(EdgeElements, OfAnEndMillFillTheDepthAndFaceOutward) {
  const Tool tool = cutter(ToolShape::end, 30);
  const int count = edge_element_count(tool, 5e-3);
  EXPECT_GE(count, 5e-3 * std::tan(pi / 6) / 5e-3 / 0.035);
  const Sums sums = summed(tool, 5e-3, count);
  EXPECT_NEAR(sums.height, 5e-3, 1e-15);
  EXPECT_NEAR(sums.length, 5e-3, 1e-15);
  EXPECT_NEAR(sums.facing_down, 0.0, 1e-15);
  EXPECT_EQ(edge_element_count(cutter(ToolShape::end, 0), 5e-3), 1);
}

// Integrals along a circle's arc from the pole to kappa_1: of sin is 1 - cos, of cos is sin.
TEST(EdgeElements, OfABallFollowTheSphere) {
  const Tool tool = cutter(ToolShape::ball, 0);
  for (const double depth : {0.2e-3, 1e-3, 5e-3}) {
    const double kappa = std::acos(1.0 - depth / 5e-3);
    const Sums sums = summed(tool, depth, 400);
    EXPECT_NEAR(sums.height, depth, 1e-5 * depth);
    EXPECT_NEAR(sums.facing_down, 5e-3 * std::sin(kappa), 1e-5 * 5e-3);
    EXPECT_NEAR(sums.length, 5e-3 * kappa, 1e-12);
    EXPECT_NEAR(profile_length(tool, depth), 5e-3 * kappa, 1e-15);
  }
}

TEST(EdgeElements, AboveTheBallTheEdgeIsACylinders) {
  const Tool tool = cutter(ToolShape::ball, 30);
  const Sums sums = summed(tool, 8e-3, 1000);
  EXPECT_NEAR(sums.height, 8e-3, 1e-5 * 8e-3);
  EXPECT_NEAR(sums.top_lag, 8e-3 * std::tan(pi / 6) / 5e-3, 1e-3);
}

// The edge of constant lead on a ball: its length is the integral of sqrt(1 + (sin^2 kappa tan(helix))^2) R dkappa.
TEST(EdgeElements, EdgeLengthCountsTheHelix) {
  const Tool tool = cutter(ToolShape::ball, 40);
  double length = 0.0;
  constexpr int kPoints = 20000;
  for (int i = 0; i < kPoints; ++i) {
    const double kappa = 0.5 * pi * (i + 0.5) / kPoints;
    length += 5e-3 * 0.5 * pi / kPoints * std::hypot(1.0, std::pow(std::sin(kappa), 2) * std::tan(deg_to_rad(40)));
  }
  EXPECT_NEAR(summed(tool, 5e-3, 2000).length, length, 1e-6 * length);
}

}  // namespace
}  // namespace stillcut
