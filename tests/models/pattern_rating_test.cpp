#include "models/pattern_rating.hpp"

#include <gtest/gtest.h>

#include "dsp/numbers.hpp"
#include "models/places.hpp"
#include "tests/models/direction_table_cases.hpp"

namespace stillcut {
namespace {

ToolPath polyline(const std::vector<Eigen::Vector2d>& points, std::optional<Milling> milling = Milling::down) {
  ToolPath path;
  for (std::size_t i = 1; i < points.size(); ++i) {
    PathMove move;
    move.from.head<2>() = points[i - 1];
    move.to.head<2>() = points[i];
    move.milling = milling;
    path.moves.push_back(move);
  }
  return path;
}

std::vector<Eigen::Vector2d> places(int columns, int rows) {
  std::vector<Eigen::Vector2d> result;
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column)
      result.emplace_back(column * kLocationSpacing, row * kLocationSpacing);
  return result;
}

TEST(PathOnLocations, EachLocationHasTheDirectionsInWhichIsCutNearIt) {
  // Along the bottom, then up the right side, of a square of three by three.
  const auto spots = places(3, 3);
  const PathOnLocations result = path_on_locations(polyline({{0, 0}, {0.1, 0}, {0.1, 0.1}}), spots);
  ASSERT_EQ(result.cuts.size(), 6u);  // both ways at the corner
  EXPECT_NEAR(result.cutting_length, 0.2, 1e-12);
  for (const LocalCut& cut : result.cuts) {
    EXPECT_NEAR(cut.share, cut.location == 2 ? 0.5 : 1.0, 1e-9) << cut.location;
    if (cut.location == 2) continue;
    const bool right_side = cut.location == 5 || cut.location == 8;
    EXPECT_NEAR(cut.direction, right_side ? std::numbers::pi / 2 : 0.0, 1e-9) << cut.location;
  }
}

TEST(PathOnLocations, APathAndTheSamePathBackwardsAreToldAlike) {
  std::vector<Eigen::Vector2d> points;
  for (double side = 0.1; side > 0.0; side -= 0.0125)  // loops, one in the other
    for (const auto& [x, y] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}, {-1, -1}})
      points.emplace_back(0.1 + x * side, 0.1 + y * side);
  const PathOnLocations forth = path_on_locations(polyline(points), places(5, 5));
  std::reverse(points.begin(), points.end());
  const PathOnLocations back = path_on_locations(polyline(points), places(5, 5));
  ASSERT_EQ(forth.cuts.size(), back.cuts.size());
  for (std::size_t i = 0; i < forth.cuts.size(); ++i) {
    EXPECT_EQ(forth.cuts[i].location, back.cuts[i].location);
    EXPECT_LT(axis_angle(forth.cuts[i].direction, back.cuts[i].direction), 1e-9);
    EXPECT_NEAR(forth.cuts[i].share, back.cuts[i].share, 1e-9);
  }
}

TEST(PathOnLocations, AShortLinkDoesNotChangeTheDirection) {
  const auto result = path_on_locations(polyline({{0, 0}, {0.1, 0}, {0.1, 0.004}, {0, 0.004}}), places(3, 1));
  EXPECT_EQ(result.cuts.size(), 3u);
  for (const LocalCut& cut : result.cuts) EXPECT_NEAR(cut.direction, 0.0, 1e-9);
}

TEST(PathOnLocations, ChordsOfAnArcCountTogether) {
  std::vector<Eigen::Vector2d> points{{0, -0.02}};
  for (int i = 0; i <= 100; ++i) {  // a gentle arc of 4 degrees, 45 mm long, and a straight piece of 20 mm across
    const double angle = deg_to_rad(-2.0 + 0.04 * i);
    points.emplace_back(0.65 * std::sin(angle), 0.65 * (1 - std::cos(angle)));
  }
  const auto result = path_on_locations(polyline(points), places(1, 1));
  ASSERT_EQ(result.cuts.size(), 2u);
  EXPECT_LT(axis_angle(result.cuts[0].direction, 0.0), deg_to_rad(2.1));
  EXPECT_NEAR(result.cuts[0].share, 0.6, 0.01) << "45 mm of arc beside 30 mm across";
}

TEST(PathOnLocations, ToAndFroIsAlternatingOnlyWhereTheMillingChanges) {
  ToolPath path = polyline({{0, 0}, {0.1, 0}, {0.1, 0.004}, {0, 0.004}});
  EXPECT_FALSE(path_on_locations(path, places(3, 1)).cuts[0].alternating);
  path.moves[2].milling = Milling::up;
  for (const LocalCut& cut : path_on_locations(path, places(3, 1)).cuts) EXPECT_TRUE(cut.alternating);
}

TEST(PathOnLocations, AirAndPlungesAreNotRated) {
  ToolPath path = polyline({{0, 0}, {0.1, 0}});
  PathMove plunge;
  plunge.from = {0, 0, 0.01};
  path.moves.insert(path.moves.begin(), plunge);
  PathMove rapid;
  rapid.from = {0.1, 0, 0};
  rapid.to = {0.1, 0.1, 0};
  rapid.cutting = false;
  path.moves.push_back(rapid);
  const auto result = path_on_locations(path, places(3, 3));
  EXPECT_EQ(result.cuts.size(), 3u);
  EXPECT_NEAR(result.air_length, 0.1, 1e-12);
}

TEST(PathOnLocations, SaysHowFarThePathStraysFromWhatWasMeasured) {
  const auto spots = places(3, 3);
  EXPECT_NEAR(reach_of(spots), kLocationSpacing, 1e-12);
  EXPECT_EQ(reach_of(places(1, 1)), kInfinity);
  EXPECT_NEAR(reach_of(std::vector<Eigen::Vector2d>{{0, 0}, {0.01, 0}, {0, 0.1}, {0.01, 0.1}}), 0.1, 1e-12)
      << "rows farther apart than columns";
  EXPECT_LT(path_on_locations(polyline({{0, 0}, {0.1, 0.1}}), spots).farthest, kLocationSpacing);
  const auto far = path_on_locations(polyline({{0, 0}, {0.3, 0}}), spots);
  EXPECT_NEAR(far.farthest, 0.2, 2e-3);
  EXPECT_NEAR(far.farthest_place.x(), 0.3, 2e-3);
}

// Limits rise along x and fall with the angle, so that every figure can be written down.
class Rating : public testing::Test {
 protected:
  static double limit(const Eigen::Vector2d& place, double direction, double speed) {
    const double at_best = (1.0 + place.x() / kLocationSpacing) * 1e-3;        // 1, 2, 3 mm
    return falling_from(0.0, direction, at_best) * (speed > 390 ? 3.0 : 1.0);  // a pocket at the top
  }
  DirectionTable table = table_of(3, 3, kLocationSpacing, 18, {300, 350, 400}, limit);
  CuttingConditions conditions{2, 0.1e-3, 0.0125, 0.2};
};

TEST_F(Rating, GivesTheIndexAsTheMeanOfTheRatios) {
  const auto path = path_on_locations(polyline({{0, 0}, {0.1, 0}, {0.1, 0.1}, {0, 0.1}}), places(3, 3));
  const PatternRating rating = rate_path(table, path, conditions);
  // Seven locations: the path leaves out the left one and the middle one of the middle row. It turns at two corners.
  double sum = 0.0, shares = 0.0;
  for (const LocalCut& cut : path.cuts) {
    sum += cut.share * falling_from(0.0, cut.direction, 1.0);
    shares += cut.share;
  }
  EXPECT_NEAR(shares, 7.0, 1e-12);
  EXPECT_NEAR(rating.asi, sum / 7.0, 1e-12);
  EXPECT_LT(rating.asi, 1.0);
  EXPECT_NEAR(rating.msi, rating.asi, 1e-12) << "here every limit falls alike";
}

TEST_F(Rating, TheBestDirectionHasFullIndexAndItsLimitsAreTheTable) {
  const auto path = path_on_locations(polyline({{0, 0}, {0.1, 0}}), places(3, 3));
  const PatternRating rating = rate_path(table, path, conditions);
  EXPECT_NEAR(rating.asi, 1.0, 1e-12);
  EXPECT_NEAR(rating.min_absolute, 1e-3, 1e-12);
  EXPECT_NEAR(rating.max_absolute, 3e-3, 1e-12);
  EXPECT_NEAR(rating.common.depth, 3e-3, 1e-12) << "the softest location's pocket";
  EXPECT_EQ(rating.common.speed, 400.0);
  const double feed_rate = 2 * 0.1e-3 * 400 / kTwoPi;
  EXPECT_NEAR(rating.removal_rate, 3e-3 * 0.0125 * feed_rate, 1e-15);
  EXPECT_NEAR(rating.time_per_depth, 0.1 / feed_rate / 3e-3, 1e-9);
}

TEST_F(Rating, ZigZagIsJudgedByTheWeakerWay) {
  ToolPath path = polyline({{0, 0}, {0.1, 0}, {0, 0}});
  path.moves[1].milling = Milling::up;
  const PatternRating rating = rate_path(table, path_on_locations(path, places(3, 3)), conditions);
  EXPECT_NEAR(rating.asi, 0.9, 1e-12);
}

TEST_F(Rating, StableBeyondTheLargestDepthCountsAsThatDepth) {
  for (LocationLimits& location : table.locations)
    for (DirectionCurve& curve : location.curves)
      for (double& depth : curve.limits) depth = kInfinity;
  const PatternRating rating =
      rate_path(table, path_on_locations(polyline({{0, 0}, {0.1, 0}}), places(3, 3)), conditions);
  EXPECT_EQ(rating.asi, 1.0);
  EXPECT_EQ(rating.max_absolute, table.max_depth);
}

TEST_F(Rating, ALocationThatIsNeverStableIsLeftOutOfTheIndexButNotOfTheLimits) {
  for (DirectionCurve& curve : table.locations[1].curves) curve.limits.assign(3, 0.0);
  const PatternRating rating =
      rate_path(table, path_on_locations(polyline({{0, 0}, {0.1, 0}}), places(3, 3)), conditions);
  EXPECT_NEAR(rating.asi, 1.0, 1e-12);
  EXPECT_EQ(rating.min_absolute, 0.0);
  EXPECT_EQ(rating.removal_rate, 0.0);
  EXPECT_EQ(rating.time_per_depth, kInfinity);
}

TEST_F(Rating, RefusesADirectionThatWasNotComputedAndAPathThatDoesNotCut) {
  const auto askew = path_on_locations(polyline({{0, 0}, {0.1, 0.0123}}), places(3, 3));
  EXPECT_THROW(rate_path(table, askew, conditions), std::invalid_argument);
  EXPECT_THROW(rate_path(table, PathOnLocations{}, conditions), std::invalid_argument);
}

}  // namespace
}  // namespace stillcut
