#include "models/interpolation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <random>
#include <stdexcept>

#include "models/machining.hpp"
#include "models/receptance.hpp"
#include "stability_cases.hpp"

namespace stillcut {
namespace {

using test::mode_of;

// Postures at random joints; two tool modes that change order and sign of direction through the map, two robot modes.
DynamicsMap random_map(std::mt19937_64& random, int count) {
  const auto uniform = [&](double low, double high) { return std::uniform_real_distribution<>(low, high)(random); };
  DynamicsMap map;
  map.has_joints = true;
  for (int i = 0; i < count; ++i) {
    Posture posture;
    posture.id = std::to_string(i + 1);
    for (double& joint : posture.joints) joint = uniform(-1.0, 1.0);
    for (double& coordinate : posture.position) coordinate = uniform(-0.2, 0.2);
    const double sign = i % 2 == 0 ? 1.0 : -1.0;
    posture.modes = {mode_of(uniform(54, 57), 0.04, 3e6, sign, 0.1), mode_of(uniform(120, 130), 0.035, 6e6, 0.1, sign),
                     mode_of(uniform(495, 515), 0.03, 2e7, 1, 0), mode_of(uniform(495, 515), 0.03, 1.8e7, 0, sign)};
    for (Mode& mode : posture.modes) {
      const double length = std::hypot(mode.direction[0], mode.direction[1]);
      for (double& component : mode.direction) component /= length;
    }
    std::sort(posture.modes.begin(), posture.modes.end(),
              [](const Mode& a, const Mode& b) { return a.natural_frequency < b.natural_frequency; });
    map.postures.push_back(posture);
  }
  return map;
}

Posture random_query(std::mt19937_64& random) {
  Posture query;
  for (double& joint : query.joints) joint = std::uniform_real_distribution<>(-1.0, 1.0)(random);
  return query;
}

TEST(Interpolation, AMeasuredPostureReturnsItsOwnModes) {
  std::mt19937_64 random(1);
  const DynamicsMap map = random_map(random, 9);
  for (const bool modal : {true, false}) {
    for (const Posture& posture : map.postures) {
      const PredictedPosture predicted =
          predict_posture(map, posture, {.kind = modal ? InterpolationKind::modal : InterpolationKind::frf});
      EXPECT_EQ(predicted.nearest, posture.id);
      EXPECT_EQ(predicted.nearest_distance, 0.0);
      ASSERT_EQ(predicted.posture.modes.size(), posture.modes.size());
      for (std::size_t i = 0; i < posture.modes.size(); ++i) {
        EXPECT_EQ(predicted.posture.modes[i].natural_frequency, posture.modes[i].natural_frequency);
        EXPECT_EQ(predicted.posture.modes[i].stiffness, posture.modes[i].stiffness);
        EXPECT_EQ(predicted.posture.modes[i].direction, posture.modes[i].direction);
      }
    }
  }
}

TEST(Interpolation, WeightsSumToOneAndFollowTheDistances) {
  std::mt19937_64 random(2);
  const DynamicsMap map = random_map(random, 12);
  for (const double power : {0.5, 1.0, 2.0, 8.0}) {
    const Posture query = random_query(random);
    const auto weights = inverse_distance_weights(map, query, power);
    EXPECT_NEAR(std::accumulate(weights.begin(), weights.end(), 0.0), 1.0, 1e-14);
    const double first = posture_distance(map.postures[0], query, true),
                 second = posture_distance(map.postures[1], query, true);
    EXPECT_NEAR(weights[0] / weights[1], std::pow(second / first, power), 1e-9 * std::pow(second / first, power));
  }
}

TEST(Interpolation, JointAnglesWrap) {
  DynamicsMap map;
  map.has_joints = true;
  Posture a, b;
  a.joints = {deg_to_rad(179), 0, 0, 0, 0, 0};
  b.joints = {deg_to_rad(-179), 0, 0, 0, 0, deg_to_rad(720)};
  EXPECT_NEAR(posture_distance(a, b, true), deg_to_rad(2), 1e-12);
  EXPECT_NEAR(posture_distance(a, b, true, {0.5, 1, 1, 1, 1, 1}), deg_to_rad(1), 1e-12);
}

TEST(Interpolation, WithoutJointsDistanceIsInSpace) {
  Posture a, b;
  a.joints = {1, 2, 3, 4, 5, 6};
  b.position = {0.003, 0.004, 0.0};
  EXPECT_NEAR(posture_distance(a, b, false), 0.005, 1e-15);
}

TEST(Interpolation, ModalKeepsTheNumberOfModesAndStaysWithinTheMeasurements) {
  std::mt19937_64 random(3);
  const DynamicsMap map = random_map(random, 15);
  for (int i = 0; i < 50; ++i) {
    const auto modes = predict_posture(map, random_query(random), {}).posture.modes;
    ASSERT_EQ(modes.size(), 4u);
    EXPECT_GT(modes[0].natural_frequency, kTwoPi * 54);
    EXPECT_LT(modes[0].natural_frequency, kTwoPi * 57);
    EXPECT_GT(std::abs(modes[0].direction[0]), 0.98);  // signs agreed before the mean was taken
    EXPECT_GT(std::abs(modes[1].direction[1]), 0.98);
    for (const Mode& mode : modes) {
      EXPECT_NEAR(std::hypot(mode.direction[0], mode.direction[1], mode.direction[2]), 1.0, 1e-12);
    }
  }
}

TEST(Interpolation, MatchesModesByDirectionWhereTheirFrequenciesCross) {
  std::mt19937_64 random(4);
  const DynamicsMap map = random_map(random, 15);
  const auto tracks = match_modes(map);
  ASSERT_EQ(tracks.size(), 4u);
  for (const ModeTrack& track : tracks) {
    for (const auto& mode : track) {
      ASSERT_TRUE(mode.has_value());
      double cosine = 0.0;
      for (std::size_t k = 0; k < 3; ++k) cosine += mode->direction[k] * track.front()->direction[k];
      EXPECT_GT(cosine, 0.9);
    }
  }
}

TEST(Interpolation, FrfIsTheWeightedSumOfTheReceptances) {
  std::mt19937_64 random(5);
  const DynamicsMap map = random_map(random, 7);
  const Posture query = random_query(random);
  const auto weights = inverse_distance_weights(map, query, 1.0);
  const auto modes = predict_posture(map, query, {.kind = InterpolationKind::frf}).posture.modes;
  EXPECT_EQ(modes.size(), 28u);
  for (const double frequency : {10.0, 350.0, 800.0, 3100.0, 9000.0}) {
    Eigen::Matrix3cd expected = Eigen::Matrix3cd::Zero();
    for (std::size_t i = 0; i < weights.size(); ++i)
      expected += weights[i] * receptance(map.postures[i].modes, frequency);
    EXPECT_LT((receptance(modes, frequency) - expected).norm(), 1e-12 * expected.norm());
  }
}

TEST(Interpolation, AModeMissedInBetweenIsTheSameBehindIt) {
  DynamicsMap map;
  for (int i = 0; i < 7; ++i) {
    Posture posture;
    posture.id = std::to_string(i);
    posture.position[0] = 0.1 * i;
    posture.modes = {{100.0 + i, 0.03, 1e6, {1, 0, 0}}, {300.0 - i, 0.03, 1e6, {0, 1, 0}}};
    if (i == 3) posture.modes.pop_back();
    map.postures.push_back(posture);
  }
  const auto tracks = match_modes(map);
  ASSERT_EQ(tracks.size(), 2U);
  for (std::size_t i = 0; i < 7; ++i) EXPECT_EQ(tracks[1][i].has_value(), i != 3);
}

TEST(Interpolation, AModeThatSomePosturesLackIsPredictedWhereMostOfTheWeightHasIt) {
  std::mt19937_64 random(6);
  DynamicsMap map = random_map(random, 2);
  map.postures[1].modes.erase(map.postures[1].modes.begin());  // the 55 Hz mode was not found here
  Posture query = map.postures[0];
  query.joints[0] += 0.01;
  EXPECT_EQ(predict_posture(map, query, {}).posture.modes.size(), 4u);
  query = map.postures[1];
  query.joints[0] += 0.01;
  EXPECT_EQ(predict_posture(map, query, {}).posture.modes.size(), 3u);
}

TEST(Interpolation, SaysWhenAPostureIsOutsideTheMap) {
  std::mt19937_64 random(7);
  const DynamicsMap map = random_map(random, 8);
  Posture query = map.postures[3];
  query.joints[0] += 1e-3;
  EXPECT_FALSE(predict_posture(map, query, {}).outside);
  for (double& joint : query.joints) joint = 3.0;
  EXPECT_TRUE(predict_posture(map, query, {}).outside);
}

TEST(Interpolation, FindsPosturesAsUsersWriteThem) {
  std::mt19937_64 random(8);
  DynamicsMap map = random_map(random, 3);
  EXPECT_EQ(find_posture(map, "2").joints, map.postures[1].joints);
  EXPECT_NEAR(find_posture(map, "10, 20,30,-40,50,60").joints[3], deg_to_rad(-40), 1e-15);
  for (const char* bad : {"4", "", "1,2,3", "1,2,3,4,5,x", "1,2,3,4,5,inf", "1,2,3,4,5,6,7"}) {
    EXPECT_THROW(find_posture(map, bad), std::invalid_argument) << bad;
  }
  map.has_joints = false;
  EXPECT_NEAR(find_posture(map, "1.5,-2,3").position[1], -0.002, 1e-15);
  EXPECT_THROW(find_posture(map, "1,2,3,4,5,6"), std::invalid_argument);
}

TEST(Interpolation, RefusesAnEmptyMapAndUnphysicalModes) {
  EXPECT_THROW(predict_posture({}, {}, {}), std::invalid_argument);
  std::mt19937_64 random(9);
  DynamicsMap map = random_map(random, 3);
  EXPECT_THROW(predict_posture(map, {}, {.power = 0.0}), std::invalid_argument);
  Posture nowhere;
  nowhere.joints[2] = std::nan("");
  EXPECT_THROW(predict_posture(map, nowhere, {}), std::invalid_argument);
  map.postures[1].modes[0].damping_ratio = 0.0;
  EXPECT_THROW(predict_posture(map, {}, {}), std::invalid_argument);
}

TEST(Receptance, IsASymmetricTensorUnderTurning) {
  std::mt19937_64 random(10);
  for (int i = 0; i < 20; ++i) {
    const auto modes = test::random_case(random).modes;
    const double frequency = std::uniform_real_distribution<>(100, 6000)(random);
    const double angle = std::uniform_real_distribution<>(0, kTwoPi)(random);
    const Eigen::Matrix3cd g = receptance(modes, frequency),
                           turned = receptance(modes_in_feed_frame(modes, angle), frequency);
    Eigen::Matrix3d r;
    r << std::cos(angle), std::sin(angle), 0, -std::sin(angle), std::cos(angle), 0, 0, 0, 1;
    EXPECT_LT((turned - r * g * r.transpose()).norm(), 1e-12 * g.norm());
    EXPECT_LT((turned - turned.transpose()).norm(), 1e-14 * g.norm());
    EXPECT_LT((receptance(modes_in_feed_frame(modes, kTwoPi), frequency) - g).norm(), 1e-12 * g.norm());
  }
}

TEST(Receptance, OfAFeedAlongYSeesTheOtherAxisPositive) {
  const std::vector<Mode> modes{mode_of(50, 0.03, 2e6, 1, 0)};
  const Eigen::Matrix3cd g = receptance(modes_in_feed_frame(modes, deg_to_rad(90)), 0.0);
  EXPECT_NEAR(g(1, 1).real(), 1.0 / 2e6, 1e-18);  // not negative, as projecting it like a vector would say
  EXPECT_NEAR(g(0, 0).real(), 0.0, 1e-18);
}

}  // namespace
}  // namespace stillcut
