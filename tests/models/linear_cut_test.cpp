#include "models/linear_cut.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <stdexcept>

#include "models/cutting_pieces.hpp"
#include "stability_cases.hpp"

namespace stillcut {
namespace {

constexpr double kPi = std::numbers::pi;

TEST(Immersion, FollowsTheMillingKind) {
  const Immersion up = immersion(Milling::up, 0.005, 0.02), down = immersion(Milling::down, 0.005, 0.02);
  EXPECT_NEAR(up.entry, 0.0, 1e-15);
  EXPECT_NEAR(up.exit, kPi / 3, 1e-12);
  EXPECT_NEAR(down.entry, 2 * kPi / 3, 1e-12);
  EXPECT_NEAR(down.exit, kPi, 1e-15);
  const Immersion slot = immersion(Milling::slot, 0.001, 0.02), full = immersion(Milling::up, 0.02, 0.02);
  EXPECT_EQ(slot.entry, 0.0);
  EXPECT_EQ(slot.exit, kPi);
  EXPECT_NEAR(full.exit, kPi, 1e-12);
}

TEST(Immersion, RefusesWhatNoToolReaches) {
  for (const double radial_depth : {0.0, -0.001, 0.0201, std::nan("")}) {
    EXPECT_THROW(immersion(Milling::down, radial_depth, 0.02), std::invalid_argument) << radial_depth;
  }
  EXPECT_THROW(immersion(Milling::down, 0.001, 0.0), std::invalid_argument);
  EXPECT_THROW(immersion(Milling::unknown, 0.001, 0.02), std::invalid_argument);
}

TEST(LinearCut, RefusesWhatTheTheoryDoesNotCover) {
  Tool tool;
  tool.teeth = 2;
  tool.diameter = 0.02;
  tool.pitch = {kPi, kPi};
  Material material;
  material.ktc = 8e8;
  Cut cut;
  cut.milling = Milling::slot;
  EXPECT_NO_THROW(linear_cut(tool, material, cut));
  const auto refused = [&](const std::function<void(Tool&, Material&)>& change) {
    Tool other_tool = tool;
    Material other_material = material;
    change(other_tool, other_material);
    EXPECT_THROW(linear_cut(other_tool, other_material, cut), std::invalid_argument);
  };
  refused([](Tool& t, Material&) { t.shape = ToolShape::ball; });
  refused([](Tool& t, Material&) { t.pitch = {kPi - 0.1, kPi + 0.1}; });
  refused([](Tool& t, Material&) { t.teeth = 0; });
  refused([](Tool& t, Material&) { t.helix = kPi / 2; });
  refused([](Tool&, Material& m) { m.ktc = 0.0; });
  refused([](Tool&, Material& m) { m.process_damping = -1.0; });
}

TEST(LinearCut, SaysWhatItLeavesOut) {
  Tool tool;
  Cut cut;
  EXPECT_TRUE(linear_cut_warnings(tool, cut).empty());
  tool.runout = 1e-5;
  cut.tilt = 0.1;
  EXPECT_EQ(linear_cut_warnings(tool, cut).size(), 2u);
}

TEST(LinearCut, StiffnessIntegralIsTheSumOfItsParts) {
  const LinearCut cut = test::cut_of(3, Milling::up, 0.4, 8e8, 3e8);
  DirectionMatrix sum = DirectionMatrix::Zero();
  constexpr int kParts = 20000;
  const double width = (cut.immersion.exit - cut.immersion.entry) / kParts;
  for (int i = 0; i < kParts; ++i) {
    const double angle = cut.immersion.entry + (i + 0.5) * width;
    sum += width * cutting_force_direction(cut, angle) * chip_normal(angle).transpose();
  }
  EXPECT_LT((sum - cutting_stiffness_integral(cut, cut.immersion.entry, cut.immersion.exit)).norm(), 1e-8 * sum.norm());
}

TEST(CuttingPieces, FillThePeriodAndHoldEveryToothsArc) {
  std::mt19937_64 random(3);
  for (int i = 0; i < 200; ++i) {
    const LinearCut cut = test::random_case(random).cut;
    const double lag = i % 3 == 0 ? 0.0 : std::uniform_real_distribution<>(0.0, 4.0)(random);
    const auto pieces = cutting_pieces(cut, lag);
    double at = 0.0, engaged = 0.0;
    for (const CuttingPiece& piece : pieces) {
      EXPECT_NEAR(piece.from, at, 1e-12);
      at = piece.to;
      engaged += static_cast<double>(piece.tooth_angle.size()) * (piece.to - piece.from);
    }
    EXPECT_NEAR(at, kTwoPi / cut.teeth, 1e-12);
    EXPECT_NEAR(engaged, cut.immersion.exit - cut.immersion.entry + lag, 1e-7);
  }
}

}  // namespace
}  // namespace stillcut
