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

using std::numbers::pi;

TEST(Immersion, FollowsTheMillingKind) {
  const Immersion up = immersion(Milling::up, 0.005, 0.02), down = immersion(Milling::down, 0.005, 0.02);
  EXPECT_NEAR(up.entry, 0.0, 1e-15);
  EXPECT_NEAR(up.exit, pi / 3, 1e-12);
  EXPECT_NEAR(down.entry, 2 * pi / 3, 1e-12);
  EXPECT_NEAR(down.exit, pi, 1e-15);
  const Immersion slot = immersion(Milling::slot, 0.001, 0.02), full = immersion(Milling::up, 0.02, 0.02);
  EXPECT_EQ(slot.entry, 0.0);
  EXPECT_EQ(slot.exit, pi);
  EXPECT_NEAR(full.exit, pi, 1e-12);
}

TEST(Immersion, RefusesWhatNoToolReaches) {
  for (const double radial_depth : {0.0, -0.001, 0.0201, std::nan("")}) {
    EXPECT_THROW(immersion(Milling::down, radial_depth, 0.02), std::invalid_argument) << radial_depth;
  }
  EXPECT_THROW(immersion(Milling::down, 0.001, 0.0), std::invalid_argument);
  EXPECT_THROW(immersion(Milling::unknown, 0.001, 0.02), std::invalid_argument);
}

struct Slot {
  Tool tool;
  Material material;
  Cut cut;

  Slot() {
    tool.teeth = 2;
    tool.diameter = 0.02;
    tool.pitch = {pi, pi};
    material.ktc = 8e8;
    cut.milling = Milling::slot;
  }
};

TEST(LinearCut, RefusesWhatIsNoTool) {
  const Slot slot;
  EXPECT_NO_THROW(linear_cut(slot.tool, slot.material, slot.cut));
  const auto refused = [](const std::function<void(Tool&, Material&)>& change) {
    Slot other;
    change(other.tool, other.material);
    EXPECT_THROW(linear_cut(other.tool, other.material, other.cut), std::invalid_argument);
  };
  refused([](Tool& t, Material&) { t.pitch = {pi - 0.1, pi + 0.2}; });
  refused([](Tool& t, Material&) { t.pitch = {-0.1, kTwoPi + 0.1}; });
  refused([](Tool& t, Material&) { t.pitch = {kTwoPi}; });
  refused([](Tool& t, Material&) { t.teeth = 0; });
  refused([](Tool& t, Material&) { t.helix = pi / 2; });
  refused([](Tool&, Material& m) { m.ktc = 0.0; });
  refused([](Tool&, Material& m) { m.process_damping = -1.0; });
}

TEST(LinearCut, KeepsThePitchOnlyWhereItVaries) {
  auto [tool, material, cut] = Slot();
  EXPECT_DOUBLE_EQ(linear_cut(tool, material, cut).period_angle(), pi);
  tool.pitch = {pi - 0.1, pi + 0.1};
  EXPECT_DOUBLE_EQ(linear_cut(tool, material, cut).period_angle(), kTwoPi);
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
      engaged += static_cast<double>(piece.teeth.size()) * (piece.to - piece.from);
    }
    EXPECT_NEAR(at, kTwoPi / cut.teeth, 1e-12);
    EXPECT_NEAR(engaged, cut.immersion.exit - cut.immersion.entry + lag, 1e-7);
  }
}

TEST(CuttingPieces, OfUnequalPitchHoldEveryToothsArc) {
  std::mt19937_64 random(4);
  for (int i = 0; i < 100; ++i) {
    const LinearCut cut = test::random_uneven_case(random, 720).cut;
    const double lag = i % 2 == 0 ? 0.0 : std::uniform_real_distribution<>(0.0, 2.0)(random);
    std::vector<double> engaged(static_cast<std::size_t>(cut.teeth), 0.0);
    double at = 0.0;
    for (const CuttingPiece& piece : cutting_pieces(cut, lag)) {
      EXPECT_NEAR(piece.from, at, 1e-12);
      at = piece.to;
      for (const EngagedTooth& tooth : piece.teeth) {
        engaged[static_cast<std::size_t>(tooth.tooth)] += piece.to - piece.from;
        EXPECT_GE(tooth.tip, cut.immersion.entry - 1e-9);
        EXPECT_LE(tooth.tip + piece.to - piece.from, cut.immersion.exit + lag + 1e-9);
      }
    }
    EXPECT_NEAR(at, kTwoPi, 1e-12);
    for (const double arc : engaged) EXPECT_NEAR(arc, cut.immersion.exit - cut.immersion.entry + lag, 1e-7);
  }
}

// A ball end's stiffness against the sum over thin discs of the published force model, edge by edge.
TEST(CuttingMatrices, OfABallEndAreTheSumOverThinDiscs) {
  LinearCut cut = test::cut_of(2, Milling::slot, 1.0, 8e8, 3e8);
  cut.shape = ToolShape::ball;
  cut.kac = 1.5e8;
  for (const double lag_per_depth : {0.0, 60.0}) {
    cut.lag_per_depth = lag_per_depth;
    for (const double depth : {0.2e-3, 3e-3, 0.0125, 0.02}) {
      const double tip = 1.3;
      Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
      constexpr int kDiscs = 200000;
      for (int i = 0; i < kDiscs; ++i) {
        // Discs of equal step in the root of the height: they crowd at the pole, where the edge is flat.
        const double low = std::pow(static_cast<double>(i) / kDiscs, 2), high = std::pow((i + 1.0) / kDiscs, 2);
        const double height = depth * 0.5 * (low + high), width = depth * (high - low);
        const double phi = tip - lag_per_depth * height;
        if (phi < cut.immersion.entry || phi > cut.immersion.exit) continue;
        const double cos_kappa = height < cut.radius ? 1.0 - height / cut.radius : 0.0;
        const double sin_kappa = std::sqrt(1.0 - cos_kappa * cos_kappa), s = std::sin(phi), c = std::cos(phi);
        Eigen::Matrix3d to_axes;  // surface paper, eq. 11: force on the tool per (tangential, radial, axial)
        to_axes << -c, -s * sin_kappa, -s * cos_kappa, s, -c * sin_kappa, -c * cos_kappa, 0.0, cos_kappa, -sin_kappa;
        const Eigen::RowVector3d normal(s * sin_kappa, c * sin_kappa, -cos_kappa);  // eq. 15
        sum -= to_axes * Eigen::Vector3d(cut.ktc, cut.krc, cut.kac) * normal * width / sin_kappa;
      }
      const Eigen::Matrix3d got = cutting_matrices(cut, tip, depth).stiffness;
      EXPECT_LT((got - sum / depth).norm(), 1e-4 * got.norm()) << depth << " m, " << lag_per_depth;
    }
  }
}

}  // namespace
}  // namespace stillcut
