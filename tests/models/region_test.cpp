// What a region may not be, and where its fault is said to lie.
#include "models/region.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <stdexcept>

namespace stillcut {
namespace {

Contour mm(const std::vector<std::array<double, 2>>& points) {
  Contour contour;
  for (const auto& [x, y] : points) contour.emplace_back(1e-3 * x, 1e-3 * y);
  return contour;
}

const Contour kPlate = mm({{0, 0}, {300, 0}, {300, 300}, {0, 300}});

std::string fault_of(const Contour& polygon) { return polygon_fault(polygon).value_or(""); }
std::string fault_of_islands(const std::vector<Contour>& islands) {
  return islands_fault({kPlate, islands}).value_or("");
}

TEST(Region, TakesWhatIsHarmless) {
  EXPECT_EQ(fault_of(kPlate), "");
  EXPECT_EQ(fault_of({kPlate.rbegin(), kPlate.rend()}), "") << "clockwise";
  // Closed by its first point, with a point twice and points along an edge.
  const Contour closed = mm({{0, 0}, {100, 0}, {200, 0}, {300, 0}, {300, 0}, {300, 300}, {0, 300}, {0, 150}, {0, 0}});
  EXPECT_EQ(fault_of(closed), "");
  EXPECT_EQ(checked_region({closed, {}}).polygon.size(), 7U);
  EXPECT_EQ(fault_of_islands({mm({{10, 10}, {20, 10}, {20, 20}}), mm({{22, 10}, {30, 10}, {22, 299.999}})}), "");
}

TEST(Region, SaysWhatIsWrongWithThePolygonAndWhere) {
  EXPECT_EQ(fault_of({}), "the polygon has 0 different points; give at least three");
  EXPECT_EQ(fault_of(mm({{0, 0}, {300, 0}, {0, 0}})), "the polygon has 2 different points; give at least three");
  EXPECT_EQ(fault_of(mm({{0, 0}, {300, 0}, {150, 0}})), "the polygon encloses no area; correct its points");
  const std::string at = "the polygon crosses or touches itself at ", advice = "; correct its points";
  EXPECT_EQ(fault_of(mm({{0, 0}, {300, 300}, {300, 0}, {0, 300}})), at + "(150, 150) mm" + advice) << "bow";
  EXPECT_EQ(fault_of(mm({{0, 0}, {300, 0}, {300, 100}, {450, 100}, {300, 100}, {0, 300}})),
            at + "(300, 100) mm" + advice)
      << "a spike";
  EXPECT_EQ(fault_of(mm({{0, 0}, {300, 0}, {300, 300}, {150, 0}, {0, 300}})), at + "(150, 0) mm" + advice)
      << "a corner on an edge";
  EXPECT_EQ(fault_of(mm({{0, 0}, {10001, 0}, {0, 300}})),
            "the polygon has a point at (10001, 0) mm, more than 10 m from the origin; correct its points");
  EXPECT_EQ(fault_of(mm({{0, 0}, {std::numeric_limits<double>::quiet_NaN(), 0}, {0, 300}})),
            "the polygon has a point that is no number; correct its points");
}

TEST(Region, SaysWhatIsWrongWithTheIslandsAndWhere) {
  const Contour small = mm({{10, 10}, {20, 10}, {20, 20}, {10, 20}});
  EXPECT_EQ(fault_of_islands({small, mm({{10, 10}, {20, 20}})}),
            "island 2 has 2 different points; give at least three");
  EXPECT_EQ(fault_of_islands({mm({{100, 100}, {200, 200}, {200, 100}, {100, 200}})}),
            "island 1 crosses or touches itself at (150, 150) mm; correct its points");
  EXPECT_EQ(fault_of_islands({mm({{290, 10}, {310, 10}, {290, 50}})}),
            "island 1 meets the polygon at (300, 10) mm; move it inside, or make it part of the polygon");
  EXPECT_EQ(fault_of_islands({mm({{300, 100}, {290, 90}, {290, 110}})}),
            "island 1 meets the polygon at (300, 100) mm; move it inside, or make it part of the polygon");
  EXPECT_EQ(fault_of_islands({small, mm({{20, 15}, {30, 10}, {30, 20}})}),
            "island 1 meets island 2 at (20, 15) mm; make one island of the two");
  EXPECT_EQ(fault_of_islands({mm({{12, 12}, {14, 12}, {12, 14}}), small}),
            "island 1 lies within island 2, at (12, 12) mm; leave it out");
  EXPECT_EQ(fault_of_islands({small, mm({{-50, -50}, {400, -50}, {400, 400}, {-50, 400}})}),
            "island 2 lies outside the polygon, at (-50, -50) mm; move it inside or leave it out");
  EXPECT_THROW(checked_region({kPlate, {small, small}}), std::invalid_argument);
}

// Against the plain definition: two edges of a random polygon that do not follow each other share a point.
TEST(Region, FindsEveryCrossingOfRandomPolygons) {
  std::mt19937 random(8);
  std::uniform_real_distribution<double> place(-1.0, 1.0);
  int crossed = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    Contour contour(3 + trial % 5);
    for (auto& point : contour) point = {place(random), place(random)};
    const std::size_t n = contour.size();
    const auto side = [&](std::size_t a, std::size_t b, std::size_t c) {
      const Eigen::Vector2d u = contour[b % n] - contour[a], v = contour[c % n] - contour[a];
      return u.x() * v.y() - u.y() * v.x() > 0.0;
    };
    bool crosses = false;
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t k = i + 2; k < n && !(i == 0 && k == n - 1); ++k)
        crosses = crosses || (side(i, i + 1, k) != side(i, i + 1, k + 1) && side(k, k + 1, i) != side(k, k + 1, i + 1));
    EXPECT_EQ(polygon_fault(contour).has_value(), crosses) << "polygon " << trial;
    crossed += crosses ? 1 : 0;
  }
  EXPECT_GT(crossed, 200);
  EXPECT_LT(crossed, 1800);
}

}  // namespace
}  // namespace stillcut
