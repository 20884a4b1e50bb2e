// The workpiece of contours: what is cut away, and what a line through the rest meets.
#include "models/part_slice.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <stdexcept>

namespace stillcut {
namespace {

Contour box(double left, double bottom, double right, double top) {
  return {{left, bottom}, {right, bottom}, {right, top}, {left, top}};
}

TEST(PartSlice, KeepsAreaAndHolesWhateverItsTiles) {
  const std::array<Contour, 2> plate{box(0, 0, 20e-3, 10e-3), box(5e-3, 2e-3, 9e-3, 8e-3)};
  for (const double tile : {0.7e-3, 1e-3, 4e-3, 50e-3}) {
    const PartSlice slice(plate, tile);
    EXPECT_NEAR(slice.area(), 200e-6 - 24e-6, 1e-12) << tile;
    const auto contours = slice.contours();
    ASSERT_EQ(contours.size(), 2u) << tile;
    EXPECT_NEAR(slice.material_along({-1e-3, 5e-3}, {30e-3, 5e-3}), 16e-3, 1e-9);
    EXPECT_NEAR(slice.material_along({1e-3, 5e-3}, {7e-3, 5e-3}), 4e-3, 1e-9);
    EXPECT_EQ(slice.material_along({6e-3, 5e-3}, {7e-3, 5e-3}), 0.0);
    EXPECT_NEAR(slice.free_way({6e-3, 5e-3}, {12e-3, 5e-3}), 3e-3, 1e-9);
    EXPECT_EQ(slice.free_way({1e-3, 5e-3}, {12e-3, 5e-3}), 0.0);
    EXPECT_TRUE(std::isinf(slice.free_way({6e-3, 5e-3}, {8e-3, 5e-3})));
  }
}

TEST(PartSlice, CutsAwayWhatIsSwept) {
  const std::array<Contour, 1> plate{box(0, 0, 20e-3, 10e-3)};
  PartSlice slice(plate);
  slice.erase(box(5.2e-3, 6e-3, 9.7e-3, 12e-3));
  EXPECT_NEAR(slice.area(), 200e-6 - 4.5e-3 * 4e-3, 1e-12);
  EXPECT_NEAR(slice.material_along({0, 8e-3}, {20e-3, 8e-3}), 15.5e-3, 2e-10);
  EXPECT_NEAR(slice.material_along({7e-3, 12e-3}, {7e-3, 1e-3}), 5e-3, 2e-10);
  slice.erase(box(-1, -1, 1, 1));
  EXPECT_EQ(slice.area(), 0.0);
  EXPECT_TRUE(slice.contours().empty());
}

// A slot of many small sectors, as edges sweep them: the wall is where the polygon of chords has it, and no sliver
// stays.
TEST(PartSlice, LeavesASlotThatSectorsSwept) {
  const std::array<Contour, 1> plate{box(0, -10e-3, 20e-3, 10e-3)};
  PartSlice slice(plate);
  constexpr int kPerTurn = 60;
  constexpr double kRadius = 3.05e-3, kFeed = 0.2e-3;
  const auto tip = [&](int i, double x) {
    const double angle = 2.0 * std::numbers::pi * i / kPerTurn;
    return Eigen::Vector2d(x + kRadius * std::sin(angle), kRadius * std::cos(angle));
  };
  for (int i = 0; i < 100 * kPerTurn; ++i) {
    const double x = -4e-3 + kFeed * i / kPerTurn, next = x + kFeed / kPerTurn;
    slice.erase(
        std::array<Eigen::Vector2d, 4>{Eigen::Vector2d(x, 0), tip(i, x), tip(i + 1, next), Eigen::Vector2d(next, 0)});
  }
  EXPECT_EQ(slice.contours().size(), 1u);
  for (double x = 2e-3; x < 10e-3; x += 0.37e-3) {
    EXPECT_NEAR(slice.free_way({x, 0}, {x, 9e-3}), kRadius, 6e-6) << x;  // cusps and the chords' sagitta
    EXPECT_EQ(slice.material_along({x, -2.9e-3}, {x, 2.9e-3}), 0.0) << x;
  }
}

// A part cut to pieces by random strokes: what lines through it meet is its area.
TEST(PartSlice, LinesThroughItAddUpToItsArea) {
  const std::array<Contour, 1> plate{box(0, 0, 6e-3, 6e-3)};
  PartSlice slice(plate);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(-1e-3, 7e-3);
  for (int i = 0; i < 40; ++i) {
    const Eigen::Vector2d a(place(random), place(random)), b(place(random), place(random));
    const Eigen::Vector2d side = 0.2e-3 * Eigen::Vector2d(a.y() - b.y(), b.x() - a.x()).normalized();
    slice.erase(std::array<Eigen::Vector2d, 4>{a - side, b - side, b + side, a + side});
  }
  double sum = 0.0;
  constexpr int kLines = 3000;
  for (int i = 0; i < kLines; ++i) {
    const double y = 6e-3 * (i + 0.5) / kLines;
    sum += slice.material_along({-1e-3, y}, {8e-3, y}) * 6e-3 / kLines;
  }
  EXPECT_NEAR(sum, slice.area(), 1e-3 * slice.area());
  EXPECT_LT(slice.area(), 25e-6);
}

TEST(PartSlice, RefusesWhatIsNoPart) {
  const Contour square = box(0, 0, 1e-2, 1e-2);
  const auto make = [](std::vector<Contour> contours, double tile) { return PartSlice(contours, tile); };
  EXPECT_THROW(make({}, 1e-3), std::invalid_argument);
  EXPECT_THROW(make({{{0, 0}, {1, 0}}}, 1e-3), std::invalid_argument);
  EXPECT_THROW(make({square}, 0.0), std::invalid_argument);
  EXPECT_THROW(make({box(0, 0, 11, 1)}, 1e-3), std::invalid_argument);
  EXPECT_THROW(make({box(0, 0, 5, 5)}, 1e-4), std::invalid_argument);
  EXPECT_THROW(make({box(0, 0, std::numeric_limits<double>::quiet_NaN(), 1)}, 1e-3), std::invalid_argument);
}

}  // namespace
}  // namespace stillcut
