#include "models/next_tap.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/models/moving_modes.hpp"

namespace stillcut {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

DynamicsMap measured(const std::vector<test::MovingMode>& modes, const std::vector<Eigen::Vector2d>& places) {
  std::mt19937_64 random(1);
  return test::tapped_map(modes, places, {}, random).map;
}

std::vector<std::string> doubts_of(const DynamicsMap& map) {
  const auto report = map.postures.size() > 1 ? std::optional(leave_one_out(map)) : std::nullopt;
  return map_doubts(map, track_modes(map), report);
}

// How far the map is off at a place, in half-widths of the mode that is most so.
double error_at(const DynamicsMap& map, const std::vector<test::MovingMode>& modes, const Posture& place,
                InterpolationKind kind) {
  const std::vector<Mode> predicted = predict_posture(map, place, {.kind = kind}).posture.modes;
  double worst = 0.0;
  for (std::size_t m = 0; m < modes.size(); ++m) {
    const Mode truth = modes[m].at({place.position[0], place.position[1]});
    worst =
        std::max(worst, std::abs(predicted[m].natural_frequency / truth.natural_frequency - 1.0) / truth.damping_ratio);
  }
  return worst;
}

TEST(NextTap, IsInTheGapOfAnEvenMap) {
  std::mt19937_64 random(3);
  const auto modes = test::moving_modes(2, 1.0, 0.1, random);
  std::vector<Eigen::Vector2d> places;
  for (const Eigen::Vector2d& place : test::grid_places(5))
    if ((place - Eigen::Vector2d(0.5, -0.5)).norm() > 0.1) places.push_back(place);  // all but this one
  const DynamicsMap map = measured(modes, places);
  const auto next = next_tap(map, leave_one_out(map));
  ASSERT_TRUE(next);
  EXPECT_NEAR(next->place.position[0], 0.5, 0.26);
  EXPECT_NEAR(next->place.position[1], -0.5, 0.26);
  EXPECT_GT(next->nearest_distance, 0.3);
}

TEST(NextTap, IsWhereTheMapIsFartherOffThanAtRandom) {
  double by_choice = 0.0, at_random = 0.0;
  for (unsigned seed = 1; seed <= 30; ++seed) {
    std::mt19937_64 random(seed);
    const auto modes = test::moving_modes(2, 1.5, 0.3, random);
    const DynamicsMap map = measured(modes, test::random_places(9, random));
    const LeaveOneOut report = leave_one_out(map);
    const auto next = next_tap(map, report);
    ASSERT_TRUE(next);
    by_choice += error_at(map, modes, next->place, InterpolationKind::modal);
    Posture any;
    for (const Eigen::Vector2d& place : test::random_places(20, random)) {
      any.position = {place.x(), place.y(), 0.0};
      at_random += error_at(map, modes, any, InterpolationKind::modal) / 20.0;
    }
  }
  EXPECT_GT(by_choice, 1.5 * at_random);
}

TEST(NextTap, OfJointsIsHalfWayTheShorterWayRound) {
  DynamicsMap map;
  map.has_joints = true;
  for (int i = 0; i < 3; ++i) {
    Posture& posture = map.postures.emplace_back();
    posture.id = std::string(1, "abc"[i]);
    posture.joints[0] =
        std::array{deg_to_rad(170.0), deg_to_rad(-170.0), deg_to_rad(-100.0)}[static_cast<std::size_t>(i)];
    posture.modes = {{kTwoPi * (20.0 + i), 0.03, 1e6, {1, 0, 0}}};
  }
  const auto next = next_tap(map, leave_one_out(map));
  ASSERT_TRUE(next);
  EXPECT_EQ(next->between, (std::array<std::string, 2>{"b", "c"}));
  EXPECT_NEAR(rad_to_deg(next->place.joints[0]), -135.0, 1e-9);
  EXPECT_NEAR(rad_to_deg(next->nearest_distance), 35.0, 1e-9);
  map.postures.resize(2);
  EXPECT_NEAR(rad_to_deg(next_tap(map, leave_one_out(map))->place.joints[0]), 180.0, 1e-9);
}

TEST(NextTap, IsNowhereForASinglePosture) {
  DynamicsMap map;
  map.postures.resize(1);
  EXPECT_FALSE(next_tap(map, {}));
}

TEST(MapDoubts, AreNoneForAGoodMap) {
  std::mt19937_64 random(2);
  EXPECT_THAT(doubts_of(measured(test::moving_modes(3, 1.0, 0.05, random), test::grid_places(4))), IsEmpty());
}

TEST(MapDoubts, NameTooFewPosturesAndHowManyItTakes) {
  std::mt19937_64 random(2);
  const auto modes = test::moving_modes(2, 1.0, 0.02, random);
  EXPECT_THAT(doubts_of(measured(modes, {{0, 0}})), Contains(HasSubstr("a single posture")));
  EXPECT_THAT(doubts_of(measured(modes, {{0, 0}, {1, 0}, {0, 1}, {1, 1}})),
              Contains(HasSubstr("too few postures: 4 that spread in 2 directions; a slope in all of them takes 5")));
  EXPECT_THAT(doubts_of(measured(modes, {{0, 0}, {1, 0}})),
              Contains(HasSubstr("too few postures: 2 that spread in 1 direction; a slope in all of them takes 3")));
  EXPECT_THAT(doubts_of(measured(modes, {{0, 0}, {0.5, 0}, {1, 0}})), Not(Contains(HasSubstr("too few"))));
}

TEST(MapDoubts, NameWhatTheMapCannotPredict) {
  std::mt19937_64 random(5);
  DynamicsMap map = measured(test::moving_modes(1, 1.0, 0.0, random), test::grid_places(4));
  for (std::size_t p = 0; p < map.postures.size(); ++p)  // unlike every neighbour
    map.postures[p].modes[0].natural_frequency *= (p / 4 + p % 4) % 2 == 0 ? 1.1 : 0.9;
  EXPECT_THAT(doubts_of(map), Contains(HasSubstr("better than the mean of them all")));
  EXPECT_THAT(doubts_of(map), Contains(HasSubstr("times half a resonance's width")));
}

TEST(MapDoubts, NameAFarPostureAndARareMode) {
  std::mt19937_64 random(5);
  auto places = test::grid_places(3);
  places.emplace_back(9.0, 0.0);
  auto modes = test::moving_modes(1, 1.0, 0.02, random);
  modes[0].turn.setZero();
  DynamicsMap map = measured(modes, places);
  map.postures[4].modes.push_back({kTwoPi * 300.0, 0.03, 1e6, {0, 0, 1}});
  EXPECT_THAT(doubts_of(map), Contains(HasSubstr("posture 10 lies farther from the others")));
  EXPECT_THAT(doubts_of(map), Contains(HasSubstr("mode 2, about 300 Hz, was found at 1 of 10 postures only (5)")));
}

}  // namespace
}  // namespace stillcut
