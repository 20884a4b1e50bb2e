#include "models/path_plan.hpp"

#include <gtest/gtest.h>

#include <numeric>

#include "dsp/numbers.hpp"
#include "models/location_grid.hpp"
#include "models/machining.hpp"
#include "tests/models/direction_table_cases.hpp"

namespace stillcut {
namespace {

std::vector<std::size_t> all_of(const DirectionTable& table) {
  std::vector<std::size_t> all(table.locations.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  return all;
}

DirectionTable random_table(int seed) {
  return table_of(4, 3, kLocationSpacing, 9, {300, 330, 360, 390},
                  [seed](const Eigen::Vector2d& p, double d, double speed) {
                    const double best = seed + 20 * p.x() + 9 * p.y() * (seed % 3);
                    return falling_from(best, d, 1e-3 * (2.0 + std::sin(seed + 40 * p.y() + 0.07 * speed + d)));
                  });
}

double share_lost(const DirectionTable& table, const PathPlan& plan) {
  double lost = 0.0;
  for (const PlannedPatch& patch : plan.patches) {
    for (const std::size_t i : patch.locations) {
      const LocationLimits& location = table.locations[i];
      lost += 1.0 - stability_ratio(table, location, curve_at(location.curves, patch.direction));
    }
  }
  return lost / static_cast<double>(table.locations.size());
}

TEST(PathPlan, IsNeverWorseThanTheBestSingleDirection) {
  for (int seed = 1; seed <= 25; ++seed) {
    const DirectionTable table = random_table(seed);
    for (const PlanObjective objective : {PlanObjective::absolute, PlanObjective::time}) {
      const PathPlan plan = plan_path(table, all_of(table), {objective, 0.03, 0.1});
      EXPECT_LE(plan.cost, plan.single_cost + 1e-12) << seed;
      if (objective == PlanObjective::absolute) {
        EXPECT_LE(share_lost(table, plan), plan.single_cost + 1e-12) << seed;
      }
    }
  }
}

TEST(PathPlan, WithoutATurningCostEveryLocationHasItsBestDirection) {
  const DirectionTable table = random_table(4);
  const PathPlan plan = plan_path(table, all_of(table), {PlanObjective::absolute, 0.0, 0.1});
  EXPECT_NEAR(plan.cost, 0.0, 1e-8);
  EXPECT_NEAR(share_lost(table, plan), 0.0, 1e-12);
}

TEST(PathPlan, DividesWhereTheBestDirectionChanges) {
  const DirectionTable table =
      table_of(4, 4, kLocationSpacing, 18, {300}, [](const Eigen::Vector2d& place, double d, double) {
        return falling_from(place.y() < 1.5 * kLocationSpacing ? deg_to_rad(30) : deg_to_rad(120), d, 1e-3);
      });
  const PathPlan plan = plan_path(table, all_of(table), {PlanObjective::absolute, 0.02, 0.1});
  ASSERT_EQ(plan.patches.size(), 2u);
  EXPECT_NEAR(plan.cost, 0.02, 1e-9) << "nothing but the change by a right angle";
  const PlannedPatch& lower = plan.patches[plan.patches[0].y_begin == -kInfinity ? 0 : 1];
  EXPECT_NEAR(lower.y_end, 1.5 * kLocationSpacing, 1e-9);
  EXPECT_NEAR(rad_to_deg(lower.direction), 30.0, 1e-9);
  const PathPlan dear = plan_path(table, all_of(table), {PlanObjective::absolute, 2.0, 0.1});
  EXPECT_EQ(dear.patches.size(), 1u);
}

// Left and right have their pockets at different speeds: one speed for all is shallow, a speed for each is deep.
TEST(PathPlan, GivesEachPatchItsSpeedWhereThatSavesTime) {
  const DirectionTable table =
      table_of(4, 2, kLocationSpacing, 6, {300, 320, 340}, [](const Eigen::Vector2d& place, double, double speed) {
        const bool left = place.x() < 1.5 * kLocationSpacing;
        return (left ? speed == 300 : speed == 340) ? 3e-3 : 0.5e-3;
      });
  const PathPlan plan = plan_path(table, all_of(table), {PlanObjective::time, 0.02, 0.1});
  ASSERT_EQ(plan.patches.size(), 2u);
  EXPECT_LT(plan.cost, 0.3);
  EXPECT_NEAR(plan.axial_depth, 0.9 * 3e-3, 1e-9);
  for (const PlannedPatch& patch : plan.patches) {
    EXPECT_EQ(patch.spindle_speed, patch.locations.front() % 4 < 2 ? 300.0 : 340.0);
    EXPECT_NEAR(patch.depth_limit, 3e-3, 1e-12);
  }
}

TEST(PathPlan, ThePlannedDepthIsStableWhereverItIsCut) {
  for (int seed = 1; seed <= 10; ++seed) {
    const DirectionTable table = random_table(seed);
    for (const PlanObjective objective : {PlanObjective::absolute, PlanObjective::time}) {
      const PathPlan plan = plan_path(table, all_of(table), {objective, 0.01, 0.1});
      std::size_t covered = 0;
      for (const PlannedPatch& patch : plan.patches) {
        const auto speed = std::find(table.speeds.begin(), table.speeds.end(), patch.spindle_speed);
        ASSERT_NE(speed, table.speeds.end());
        for (const std::size_t i : patch.locations) {
          ++covered;
          const auto& limits = curve_at(table.locations[i].curves, patch.direction).limits;
          EXPECT_GE(limits[static_cast<std::size_t>(speed - table.speeds.begin())] * 0.9, plan.axial_depth - 1e-12);
        }
      }
      EXPECT_EQ(covered, table.locations.size());
    }
  }
}

TEST(PathPlan, OnlyTheUsedLocationsCount) {
  DirectionTable table = random_table(2);
  for (DirectionCurve& curve : table.locations[11].curves) curve.limits.assign(4, 0.0);
  std::vector<std::size_t> used = all_of(table);
  EXPECT_THROW(plan_path(table, used, {PlanObjective::time, 0.02, 0.1}), std::invalid_argument);
  used.pop_back();
  EXPECT_NO_THROW(plan_path(table, used, {PlanObjective::time, 0.02, 0.1}));
  EXPECT_THROW(plan_path(table, std::vector<std::size_t>{}, {}), std::invalid_argument);
}

TEST(LocationGrid, GathersScatteredPlacesIntoFewLines) {
  std::vector<Eigen::Vector2d> places;
  for (int i = 0; i < 30; ++i) places.emplace_back(0.01 * i + (i % 5) * 1e-4, 0.3 * ((i * 7) % 30) / 30.0);
  const LocationGrid grid = location_grid(places, 6);
  EXPECT_LE(grid.columns(), 6);
  EXPECT_LE(grid.rows(), 6);
  for (std::size_t i = 0; i < places.size(); ++i) {
    EXPECT_GE(grid.column[i], 0);
    EXPECT_LT(grid.column[i], grid.columns());
    if (grid.column[i] == 0) continue;
    EXPECT_GT(places[i].x(), grid.x_lines[static_cast<std::size_t>(grid.column[i] - 1)]);
  }
  const LocationGrid regular = location_grid(std::vector<Eigen::Vector2d>{{0, 0}, {0.05, 0}, {0.1, 0}});
  EXPECT_EQ(regular.columns(), 3);
  EXPECT_EQ(regular.rows(), 1);
  EXPECT_NEAR(regular.x_lines[0], 0.025, 1e-12);
}

}  // namespace
}  // namespace stillcut
