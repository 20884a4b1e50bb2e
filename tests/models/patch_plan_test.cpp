#include "models/patch_plan.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "dsp/numbers.hpp"

namespace stillcut {
namespace {

// Costs drawn at random for every location and direction, a plan's cost added up by its definition.
struct RandomCosts {
  int columns, rows, directions;
  std::vector<double> of;  // [column][row][direction]
  double turning;

  RandomCosts(int columns_, int rows_, int directions_, double turning_, unsigned seed)
      : columns(columns_), rows(rows_), directions(directions_), turning(turning_) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    of.resize(static_cast<std::size_t>(columns * rows * directions));
    for (double& cost : of) cost = uniform(random);
  }

  [[nodiscard]] double patch(const GridRectangle& r, int direction) const {
    double sum = 0.0;
    for (int c = r.column_begin; c < r.column_end; ++c)
      for (int row = r.row_begin; row < r.row_end; ++row)
        sum += of[static_cast<std::size_t>((c * rows + row) * directions + direction)];
    return sum;
  }
  [[nodiscard]] double change(int a, int b) const { return turning * (0.3 + std::abs(a - b)); }

  [[nodiscard]] double of_plan(const std::vector<Patch>& patches) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < patches.size(); ++i) {
      sum += patch(patches[i].rectangle, patches[i].direction);
      if (i > 0) sum += change(patches[i - 1].direction, patches[i].direction);
    }
    return sum;
  }

  [[nodiscard]] PatchCosts costs() const {
    return {columns, rows, directions, [this](const GridRectangle& r, int d) { return patch(r, d); },
            [this](int a, int b) { return change(a, b); }};
  }
};

// Every plan there is, one by one.
std::vector<std::vector<Patch>> all_plans(const GridRectangle& r, int directions) {
  std::vector<std::vector<Patch>> plans;
  for (int d = 0; d < directions; ++d) plans.push_back({{r, d}});
  const auto cut = [&](const GridRectangle& one, const GridRectangle& other) {
    const auto first = all_plans(one, directions), second = all_plans(other, directions);
    for (const auto& a : first) {
      for (const auto& b : second) {
        std::vector<Patch> forth(a), back(b);
        forth.insert(forth.end(), b.begin(), b.end());
        back.insert(back.end(), a.begin(), a.end());
        plans.push_back(forth);
        plans.push_back(back);
      }
    }
  };
  for (int c = r.column_begin + 1; c < r.column_end; ++c)
    cut({r.column_begin, c, r.row_begin, r.row_end}, {c, r.column_end, r.row_begin, r.row_end});
  for (int row = r.row_begin + 1; row < r.row_end; ++row)
    cut({r.column_begin, r.column_end, r.row_begin, row}, {r.column_begin, r.column_end, row, r.row_end});
  return plans;
}

struct Grid {
  int columns, rows, directions;
};

class PatchPlanAgainstExhaustiveSearch : public testing::TestWithParam<Grid> {};

TEST_P(PatchPlanAgainstExhaustiveSearch, IsAsCheapAsTheCheapestOfAllPlans) {
  const auto [columns, rows, directions] = GetParam();
  const auto plans = all_plans({0, columns, 0, rows}, directions);
  int divided = 0;
  for (unsigned seed = 1; seed <= 12; ++seed) {
    const RandomCosts random(columns, rows, directions, 0.04 * seed, seed);
    double cheapest = kInfinity;
    for (const auto& plan : plans) cheapest = std::min(cheapest, random.of_plan(plan));
    const PatchPlan found = plan_patches(random.costs());
    EXPECT_NEAR(found.cost, cheapest, 1e-9) << "seed " << seed;
    EXPECT_NEAR(random.of_plan(found.patches), found.cost, 1e-9) << "seed " << seed;
    divided += found.patches.size() > 1;
  }
  EXPECT_GT(divided, 3) << "the cases are too easy to show anything";
}

INSTANTIATE_TEST_SUITE_P(SmallGrids, PatchPlanAgainstExhaustiveSearch,
                         testing::Values(Grid{4, 1, 3}, Grid{1, 4, 3}, Grid{2, 2, 4}, Grid{3, 2, 2}, Grid{3, 2, 3}));

TEST(PatchPlan, CoversEveryCellOnce) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const RandomCosts random(7, 7, 9, 0.3, seed);
    const PatchPlan plan = plan_patches(random.costs());
    std::vector<int> covered(49, 0);
    for (const Patch& patch : plan.patches)
      for (int c = patch.rectangle.column_begin; c < patch.rectangle.column_end; ++c)
        for (int r = patch.rectangle.row_begin; r < patch.rectangle.row_end; ++r)
          ++covered[static_cast<std::size_t>(c * 7 + r)];
    EXPECT_EQ(covered, std::vector<int>(49, 1)) << "seed " << seed;
    EXPECT_NEAR(random.of_plan(plan.patches), plan.cost, 1e-9);
  }
}

TEST(PatchPlan, IsNeverDearerThanOneDirectionForAll) {
  for (unsigned seed = 1; seed <= 50; ++seed) {
    const RandomCosts random(6, 5, 12, 0.02 * seed, seed);
    double single = kInfinity;
    for (int d = 0; d < 12; ++d) single = std::min(single, random.patch({0, 6, 0, 5}, d));
    EXPECT_LE(plan_patches(random.costs()).cost, single + 1e-9) << "seed " << seed;
  }
}

TEST(PatchPlan, WithoutATurningCostTakesTheBestOfEachLocationAndWithAHighOneIsUndivided) {
  const RandomCosts free(4, 4, 6, 0.0, 5);
  double best = 0.0;
  for (int c = 0; c < 4; ++c) {
    for (int r = 0; r < 4; ++r) {
      double least = kInfinity;
      for (int d = 0; d < 6; ++d) least = std::min(least, free.patch({c, c + 1, r, r + 1}, d));
      best += least;
    }
  }
  EXPECT_NEAR(plan_patches(free.costs()).cost, best, 1e-9);
  const RandomCosts dear(4, 4, 6, 100.0, 5);
  EXPECT_EQ(plan_patches(dear.costs()).patches.size(), 1u);
}

TEST(PatchPlan, LeavesOutWhatIsNotPossible) {
  RandomCosts random(3, 1, 2, 0.01, 3);
  for (int c = 0; c < 3; ++c) random.of[static_cast<std::size_t>(c * 2 + (c == 1 ? 0 : 1))] = kInfinity;
  const PatchPlan plan = plan_patches(random.costs());
  ASSERT_TRUE(std::isfinite(plan.cost));
  for (const Patch& patch : plan.patches)
    for (int c = patch.rectangle.column_begin; c < patch.rectangle.column_end; ++c)
      EXPECT_EQ(patch.direction, c == 1 ? 1 : 0);
  random.of[2] = kInfinity;
  random.of[3] = kInfinity;
  EXPECT_FALSE(std::isfinite(plan_patches(random.costs()).cost));
}

TEST(PatchPlan, RefusesSizesThatItCannotSearch) {
  const RandomCosts random(2, 2, 2, 0.1, 1);
  PatchCosts costs = random.costs();
  costs.columns = 13;
  EXPECT_THROW(plan_patches(costs), std::invalid_argument);
  costs.columns = 0;
  EXPECT_THROW(plan_patches(costs), std::invalid_argument);
}

}  // namespace
}  // namespace stillcut
