#include "models/posture_trend.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <random>

#include "models/interpolation.hpp"
#include "models/machining.hpp"

namespace stillcut {
namespace {

// Postures on a plane of a few joints (the others follow them), as a machining plane gives them.
DynamicsMap plane(std::mt19937_64& random, int count, bool has_joints) {
  std::uniform_real_distribution<> along(-0.5, 0.5);
  DynamicsMap map;
  map.has_joints = has_joints;
  for (int i = 0; i < count; ++i) {
    Posture posture;
    posture.id = std::to_string(i + 1);
    const double a = along(random), b = along(random);
    posture.joints = {a, b, 0.5 * b - a, 0.3 * a, -0.2 * b, 0.1 * a};
    posture.position = {a, b, 0.3};
    posture.modes = {{100.0 * std::exp(0.3 * a - 0.2 * b), 0.03, 1e6 * std::exp(a + b), {1, 0, 0}},
                     {300.0 * std::exp(0.1 * b), 0.02, 5e6, {0, 1, 0}}};
    map.postures.push_back(posture);
  }
  return map;
}

TEST(PostureTrend, ReproducesAPlaneWhereverItIsAsked) {
  std::mt19937_64 random(1);
  for (const bool has_joints : {true, false}) {
    for (int trial = 0; trial < 50; ++trial) {
      const DynamicsMap map = plane(random, 6 + trial % 10, has_joints);
      const Posture query = plane(random, 1, has_joints).postures.front();
      const auto plain = inverse_distance_weights(map, query, 1.0 + 0.5 * (trial % 3));
      const auto weights = trend_weights(map, query, plain);
      EXPECT_NEAR(std::accumulate(weights.begin(), weights.end(), 0.0), 1.0, 1e-12);
      double log_frequency = 0.0;
      for (std::size_t i = 0; i < weights.size(); ++i)
        log_frequency += weights[i] * std::log(map.postures[i].modes[0].natural_frequency);
      EXPECT_NEAR(log_frequency, std::log(query.modes[0].natural_frequency), 1e-7);
    }
  }
}

TEST(PostureTrend, GivesAMeasuredPostureAllTheWeightAndComesThereWithoutALeap) {
  std::mt19937_64 random(2);
  const DynamicsMap map = plane(random, 12, true);
  for (const Posture& posture : map.postures) {
    const auto at = trend_weights(map, posture, inverse_distance_weights(map, posture, 1.0));
    Posture beside = posture;
    beside.joints[0] += 1e-6;
    const auto near = trend_weights(map, beside, inverse_distance_weights(map, beside, 1.0));
    for (std::size_t i = 0; i < at.size(); ++i) {
      EXPECT_EQ(at[i], map.postures[i].id == posture.id ? 1.0 : 0.0);
      EXPECT_NEAR(near[i], at[i], 1e-3);
    }
  }
}

TEST(PostureTrend, LeavesPlainWeightsWhereThereIsNoPlane) {
  std::mt19937_64 random(3);
  for (const int count : {1, 2}) {
    const DynamicsMap map = plane(random, count, true);
    const Posture query = plane(random, 1, true).postures.front();
    const auto plain = inverse_distance_weights(map, query, 1.0);
    EXPECT_EQ(trend_weights(map, query, plain), plain);
  }
}

TEST(PostureTrend, PostureWithoutWeightPlaysNoPart) {
  std::mt19937_64 random(4);
  DynamicsMap map = plane(random, 9, true);
  const Posture query = plane(random, 1, true).postures.front();
  auto plain = inverse_distance_weights(map, query, 1.0);
  plain[4] = 0.0;
  const auto weights = trend_weights(map, query, plain);
  EXPECT_EQ(weights[4], 0.0);
  map.postures.erase(map.postures.begin() + 4);
  const auto without = trend_weights(map, query, inverse_distance_weights(map, query, 1.0));
  for (std::size_t i = 0; i < without.size(); ++i) EXPECT_NEAR(without[i], weights[i < 4 ? i : i + 1], 1e-12);
}

TEST(PostureTrend, PredictionStaysPhysicalFarOutside) {
  std::mt19937_64 random(5);
  DynamicsMap map = plane(random, 15, true);
  for (Posture& posture : map.postures) posture.modes[0].damping_ratio = 0.5 + 0.4 * std::tanh(4 * posture.joints[0]);
  for (int trial = 0; trial < 100; ++trial) {
    Posture query;
    for (double& joint : query.joints) joint = std::uniform_real_distribution<>(-3, 3)(random);
    const PredictedPosture predicted = predict_posture(map, query, {.kind = InterpolationKind::trend});
    EXPECT_TRUE(predicted.outside);
    ASSERT_EQ(predicted.posture.modes.size(), 2U);
    for (const Mode& mode : predicted.posture.modes) {
      EXPECT_GT(mode.natural_frequency, 0.0);
      EXPECT_TRUE(mode.damping_ratio > 0.0 && mode.damping_ratio < 1.0) << mode.damping_ratio;
      EXPECT_GT(mode.stiffness, 0.0);
      EXPECT_LT(mode.natural_frequency, 1000.0);  // no farther beyond the map than the map is wide
      EXPECT_NEAR(std::hypot(mode.direction[0], mode.direction[1], mode.direction[2]), 1.0, 1e-12);
    }
  }
}

TEST(PostureTrend, MeasuredPosturesReturnTheirOwnModes) {
  std::mt19937_64 random(6);
  const DynamicsMap map = plane(random, 8, true);
  for (const Posture& posture : map.postures) {
    const auto modes = predict_posture(map, posture, {.kind = InterpolationKind::trend}).posture.modes;
    ASSERT_EQ(modes.size(), posture.modes.size());
    for (std::size_t m = 0; m < modes.size(); ++m)
      EXPECT_EQ(modes[m].natural_frequency, posture.modes[m].natural_frequency);
  }
}

TEST(OutsideMap, TextNamesPostureDistanceAndUnit) {
  std::mt19937_64 random(7);
  for (const bool has_joints : {true, false}) {
    const DynamicsMap map = plane(random, 6, has_joints);
    Posture query;
    query.id = "far";
    query.joints = {2, 0, 0, 0, 0, 0};
    query.position = {2, 0, 0};
    const PredictedPosture predicted = predict_posture(map, query, {});
    ASSERT_TRUE(predicted.outside);
    const std::string text = outside_map_text(predicted);
    EXPECT_NE(text.find("\"far\""), std::string::npos) << text;
    EXPECT_NE(text.find('"' + predicted.nearest + '"'), std::string::npos) << text;
    EXPECT_NE(text.find(posture_distance_text(predicted.nearest_distance, has_joints)), std::string::npos) << text;
    EXPECT_NE(text.find(has_joints ? " deg " : " mm "), std::string::npos) << text;
  }
  EXPECT_EQ(posture_distance_text(kTwoPi / 8.0, true), "45 deg");
  EXPECT_EQ(posture_distance_text(0.0345, false), "34.5 mm");
}

}  // namespace
}  // namespace stillcut
