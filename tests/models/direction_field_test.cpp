#include "models/direction_field.hpp"

#include <gtest/gtest.h>

#include "models/machining.hpp"
#include "tests/models/direction_table_cases.hpp"

namespace stillcut {
namespace {

TEST(DirectionField, FindsTheBestDirectionAndThoseWithinTheTolerance) {
  const DirectionTable table = table_of(
      3, 3, kLocationSpacing, 36, {300, 350, 400},
      [](const auto&, double d, double speed) { return falling_from(deg_to_rad(50), d, 1e-3 + 1e-6 * speed); });
  const DirectionField field = direction_field(table, 0.1);
  for (const ChosenDirection& choice : field.locations) {
    EXPECT_NEAR(rad_to_deg(choice.best), 50.0, 1e-9);
    EXPECT_FALSE(choice.outlier);
    for (std::size_t d = 0; d < table.directions.size(); ++d) {
      const double ratio = falling_from(deg_to_rad(50), table.directions[d], 1.0) / falling_from(0, 0, 1.0);
      EXPECT_EQ(choice.near[d], ratio >= 0.9) << d;
    }
  }
  ASSERT_EQ(field.groups.size(), 1u);
  EXPECT_NEAR(rad_to_deg(field.groups[0].direction), 50.0, 1e-9);
}

// One location prefers 120 degrees by a hair; 50 is nearly as good there.
TEST(DirectionField, BringsAnOutlierBackToItsNeighbours) {
  const DirectionTable table =
      table_of(3, 3, kLocationSpacing, 36, {300}, [](const Eigen::Vector2d& place, double d, double) {
        const bool odd = (place - Eigen::Vector2d(kLocationSpacing, kLocationSpacing)).norm() < 1e-9;
        const double usual = falling_from(deg_to_rad(50), d, 1e-3);
        return odd ? std::max(0.95 * usual, falling_from(deg_to_rad(120), d, 1e-3)) : usual;
      });
  const DirectionField field = direction_field(table, 0.1);
  const ChosenDirection& odd = field.locations[4];
  EXPECT_NEAR(rad_to_deg(odd.best), 120.0, 1e-9);
  EXPECT_TRUE(odd.outlier);
  EXPECT_LE(axis_angle(odd.chosen, deg_to_rad(50)), deg_to_rad(5.0) + 1e-9);
  EXPECT_EQ(field.groups.size(), 1u);
  const DirectionField strict = direction_field(table, 0.01);
  EXPECT_NEAR(rad_to_deg(strict.locations[4].chosen), 120.0, 5.01) << "what is not nearly as good is not chosen";
}

TEST(DirectionField, AngleWrapsWhereNeighboursStraddleHalfATurn) {
  const DirectionTable table =
      table_of(4, 4, kLocationSpacing, 36, {300}, [](const Eigen::Vector2d& place, double d, double) {
        return falling_from(place.x() < 1.5 * kLocationSpacing ? deg_to_rad(175) : 0.0, d, 1e-3);
      });
  for (const ChosenDirection& choice : direction_field(table).locations) EXPECT_FALSE(choice.outlier);
}

TEST(DirectionField, GathersTwoHalvesIntoTwoGroups) {
  const DirectionTable table =
      table_of(4, 3, kLocationSpacing, 18, {300}, [](const Eigen::Vector2d& place, double d, double) {
        return falling_from(place.x() < 1.5 * kLocationSpacing ? deg_to_rad(20) : deg_to_rad(110), d, 1e-3);
      });
  const DirectionField field = direction_field(table);
  ASSERT_EQ(field.groups.size(), 2u);
  EXPECT_EQ(field.groups[0].locations.size(), 6u);
  EXPECT_EQ(field.groups[1].locations.size(), 6u);
  for (const DirectionGroup& group : field.groups)
    for (const std::size_t i : group.locations)
      EXPECT_EQ(table.locations[i].place.x() < 1.5 * kLocationSpacing, std::abs(rad_to_deg(group.direction) - 20) < 15);
}

// At 400 rad/s every location has a direction with a deep pocket that is not its best at any speed.
TEST(GlobalChoice, FindsTheCommonPocketThatTheLocalChoiceMisses) {
  const auto limit = [](const Eigen::Vector2d&, double d, double speed) {
    const bool pocket = speed > 390 && axis_angle(d, deg_to_rad(130)) < 0.01;
    return pocket ? 4e-3 : falling_from(deg_to_rad(40), d, 1e-3);
  };
  const DirectionTable table = table_of(3, 2, kLocationSpacing, 18, {300, 350, 400}, limit);
  const DirectionField field = direction_field(table);
  std::vector<double> local;
  for (const ChosenDirection& choice : field.locations) local.push_back(choice.chosen);
  const Pocket found_locally = common_pocket(table, local);
  const GlobalChoice global = global_choice(table, field);
  EXPECT_NEAR(found_locally.depth, 1e-3, 1e-9);
  EXPECT_NEAR(global.common.depth, 4e-3, 1e-12);
  EXPECT_EQ(global.common.speed, 400.0);
  for (const double direction : global.directions) EXPECT_NEAR(rad_to_deg(direction), 130.0, 1e-9);
}

TEST(GlobalChoice, IsNeverBelowWhatTheLocalChoiceLeaves) {
  for (int seed = 1; seed <= 20; ++seed) {
    const DirectionTable table = table_of(
        4, 4, kLocationSpacing, 12, {300, 320, 340, 360}, [seed](const Eigen::Vector2d& p, double d, double speed) {
          return 1e-3 *
                 (2.0 + std::sin(seed * 37.0 + 60 * p.x() + 3 * d + speed) + std::cos(90 * p.y() * seed - 5 * d));
        });
    const DirectionField field = direction_field(table);
    std::vector<double> local;
    for (const ChosenDirection& choice : field.locations) local.push_back(choice.chosen);
    const GlobalChoice global = global_choice(table, field);
    EXPECT_GE(global.common.depth, common_pocket(table, local).depth) << seed;
    EXPECT_NEAR(common_pocket(table, global.directions).depth, global.common.depth, 1e-15) << seed;
  }
}

TEST(DirectionField, RefusesAToleranceThatIsNoShare) {
  const DirectionTable table =
      table_of(1, 1, kLocationSpacing, 4, {300}, [](const auto&, double, double) { return 1e-3; });
  EXPECT_THROW(direction_field(table, -0.1), std::invalid_argument);
  EXPECT_THROW(direction_field(table, 1.5), std::invalid_argument);
  EXPECT_EQ(direction_field(table, 0.1).groups.size(), 1u);
}

}  // namespace
}  // namespace stillcut
