#include "models/cheapest_pairs.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace stillcut {
namespace {

using Costs = std::vector<std::vector<double>>;

double sum_of(const Costs& cost, const std::vector<int>& pairs, double alone) {
  double sum = alone * static_cast<double>(cost.size() + cost.front().size());
  for (std::size_t i = 0; i < pairs.size(); ++i)
    if (pairs[i] >= 0) sum += cost[i][static_cast<std::size_t>(pairs[i])] - 2.0 * alone;
  return sum;
}

// The smallest sum, by trying everything.
double least_sum(const Costs& cost, double alone, std::vector<int>& pairs) {
  const std::size_t row = pairs.size();
  if (row == cost.size()) return sum_of(cost, pairs, alone);
  double least = 1e300;
  for (int column = -1; column < static_cast<int>(cost.front().size()); ++column) {
    if (column >= 0 && std::find(pairs.begin(), pairs.end(), column) != pairs.end()) continue;
    pairs.push_back(column);
    least = std::min(least, least_sum(cost, alone, pairs));
    pairs.pop_back();
  }
  return least;
}

TEST(CheapestPairs, HaveTheSmallestSumOfAllAssignments) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<> unit(0.0, 1.0);
  for (int i = 0; i < 300; ++i) {
    Costs cost(1 + random() % 5, std::vector<double>(1 + random() % 5));
    for (auto& row : cost)
      for (double& value : row) value = i % 3 == 0 ? std::round(4.0 * unit(random)) / 4.0 : unit(random);  // ties too
    const double alone = unit(random);
    const std::vector<int> pairs = cheapest_pairs(cost, alone);
    ASSERT_EQ(pairs.size(), cost.size());
    std::vector<int> taken;
    for (const int pair : pairs)
      if (pair >= 0) taken.push_back(pair);
    std::sort(taken.begin(), taken.end());
    EXPECT_TRUE(std::adjacent_find(taken.begin(), taken.end()) == taken.end());
    std::vector<int> none;
    EXPECT_NEAR(sum_of(cost, pairs, alone), least_sum(cost, alone, none), 1e-12);
  }
}

TEST(CheapestPairs, LeaveAloneWhatIsTooDearAndTakeAnEmptyTable) {
  EXPECT_EQ(cheapest_pairs({{1.1}}, 0.5), std::vector<int>{-1});
  EXPECT_EQ(cheapest_pairs({{0.9}}, 0.5), std::vector<int>{0});
  EXPECT_TRUE(cheapest_pairs({}, 0.5).empty());
  EXPECT_EQ(cheapest_pairs({{}, {}}, 0.5), (std::vector<int>{-1, -1}));
}

}  // namespace
}  // namespace stillcut
