#include "rt/correction_memory.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "dsp/numbers.hpp"

namespace stillcut {
namespace {

// A corner of the part; the tool stands half a metre further on at each.
CutPlace corner(int number) {
  CutPlace place;
  place.joints = {0.1, -1.2, 1.5, 0.0, 0.8, 3.0};
  place.tcp = {0.5 * number, 0.2, -0.1};
  place.programmed_speed = 900.0;
  place.feed_direction = 3.1;
  place.axial_depth = 1e-3;
  return place;
}

Remembered speed_at(const CutPlace& place, double speed) {
  Remembered worked;
  worked.place = place;
  worked.setting.speed = speed;
  return worked;
}

TEST(CorrectionMemory, AnEmptyOneKnowsNothingNotEvenOfThePlaceOfZeros) {
  const CorrectionMemory memory;
  EXPECT_EQ(memory.recall({}), nullptr);
  EXPECT_EQ(memory.recall(corner(1)), nullptr);
}

TEST(CorrectionMemory, WhatWorkedIsRecalledAtItsPlaceOnly) {
  CorrectionMemory memory;
  for (int i = 0; i < 5; ++i) memory.keep(speed_at(corner(i), 1000.0 + i));
  for (int i = 0; i < 5; ++i) {
    const Remembered* known = memory.recall(corner(i));
    ASSERT_NE(known, nullptr);
    EXPECT_EQ(known->setting.speed, 1000.0 + i);
  }
  EXPECT_EQ(memory.recall(corner(5)), nullptr);
}

TEST(CorrectionMemory, ADifferenceOfPostureSpeedOrDirectionMakesAnotherPlaceASmallOneDoesNot) {
  CorrectionMemory memory;
  memory.keep(speed_at(corner(0), 1000.0));
  std::vector<CutPlace> near, far;
  const auto beside = [&](double& (*part)(CutPlace&), double small, double large) {
    for (const double sign : {-1.0, 1.0}) {
      near.push_back(corner(0));
      part(near.back()) += sign * small;
      far.push_back(corner(0));
      part(far.back()) += sign * large;
    }
  };
  beside([](CutPlace& p) -> double& { return p.joints[0]; }, 0.05, 0.12);
  beside([](CutPlace& p) -> double& { return p.joints[5]; }, 0.05, 0.12);
  beside([](CutPlace& p) -> double& { return p.tcp[0]; }, 0.03, 0.06);
  beside([](CutPlace& p) -> double& { return p.tcp[2]; }, 0.03, 0.06);
  beside([](CutPlace& p) -> double& { return p.programmed_speed; }, 10.0, 25.0);
  beside([](CutPlace& p) -> double& { return p.feed_direction; }, 0.05, 0.12);
  for (const CutPlace& place : near) EXPECT_NE(memory.recall(place), nullptr);
  for (const CutPlace& place : far) EXPECT_EQ(memory.recall(place), nullptr);
}

TEST(CorrectionMemory, AFullTurnIsTheSameAngle) {
  CorrectionMemory memory;
  memory.keep(speed_at(corner(0), 1000.0));
  for (const int turns : {-2, -1, 1, 2}) {
    CutPlace turned = corner(0);
    turned.feed_direction += 2.0 * std::numbers::pi * turns;
    EXPECT_NE(memory.recall(turned), nullptr);
    turned.joints[5] += 2.0 * std::numbers::pi * turns;
    EXPECT_NE(memory.recall(turned), nullptr);
    turned.feed_direction += std::numbers::pi;  // the feed goes back: another cut
    EXPECT_EQ(memory.recall(turned), nullptr);
  }
  CutPlace beyond = corner(0);
  beyond.feed_direction = -3.15;  // 3.133 the other way round
  EXPECT_NE(memory.recall(beyond), nullptr);
}

TEST(CorrectionMemory, DeeperIsAnotherQuestionShallowerIsNot) {
  CorrectionMemory memory;
  memory.keep(speed_at(corner(0), 1000.0));
  CutPlace cut = corner(0);
  for (const double known : {0.1e-3, 1e-3, 1.05e-3, kNaN}) {
    cut.axial_depth = known;
    EXPECT_NE(memory.recall(cut), nullptr) << known;
  }
  cut.axial_depth = 1.2e-3;
  EXPECT_EQ(memory.recall(cut), nullptr);
  memory.keep(speed_at(cut, 1100.0));  // once it has worked there
  ASSERT_NE(memory.recall(cut), nullptr);
  EXPECT_EQ(memory.recall(corner(0))->setting.speed, 1100.0);
}

TEST(CorrectionMemory, WhatWorksNowReplacesWhatWorkedThen) {
  CorrectionMemory memory;
  for (int i = 0; i < 100; ++i) {
    CutPlace place = corner(0);
    place.joints[1] += 0.02 * std::sin(i);
    memory.keep(speed_at(place, 1000.0 + i));
    EXPECT_EQ(memory.recall(place)->setting.speed, 1000.0 + i);
  }
  memory.keep(speed_at(corner(1), 900.0));
  EXPECT_EQ(memory.recall(corner(0))->setting.speed, 1099.0);  // nor did the hundred push out anything
}

TEST(CorrectionMemory, TheOldestPlaceGoesFirst) {
  CorrectionMemory memory;
  constexpr int kRoom = CorrectionMemory::kPlaces;
  for (int i = 0; i < 3 * kRoom; ++i) {
    memory.keep(speed_at(corner(i), 1000.0 + i));
    for (int j = 0; j <= i; ++j) {
      const Remembered* known = memory.recall(corner(j));
      ASSERT_EQ(known != nullptr, j > i - kRoom) << j << " of " << i;
      if (known != nullptr) {
        EXPECT_EQ(known->setting.speed, 1000.0 + j);
      }
    }
  }
}

TEST(CorrectionMemory, ForgottenIsForgottenAndNothingElse) {
  CorrectionMemory memory;
  memory.forget(corner(0), 1000.0);
  for (int i = 0; i < 4; ++i) memory.keep(speed_at(corner(i), 1000.0 + i));
  memory.forget(corner(2), 1002.0);
  memory.forget(corner(2), 1002.0);
  memory.forget(corner(3), 1100.0);  // another speed than the one that worked
  memory.forget(corner(9), 1000.0);
  for (int i = 0; i < 4; ++i) EXPECT_EQ(memory.recall(corner(i)) == nullptr, i == 2);
  memory.keep(speed_at(corner(2), 1500.0));
  EXPECT_EQ(memory.recall(corner(2))->setting.speed, 1500.0);
}

// Places run into one another along a path: a speed that was forgotten must not come back from the one beside it.
TEST(CorrectionMemory, AlongAPathWhatWasKeptIsRecalledAndWhatWasForgottenIsNot) {
  std::mt19937_64 random{5};
  std::uniform_real_distribution<double> along(0.0, 0.6);
  CorrectionMemory memory;
  for (int i = 0; i < 20000; ++i) {
    CutPlace place = corner(0);
    place.joints[0] = along(random);
    if (i % 3 == 0) {
      const Remembered* known = memory.recall(place);
      if (known == nullptr) continue;
      const double failed = known->setting.speed;
      memory.forget(place, failed);
      known = memory.recall(place);
      ASSERT_TRUE(known == nullptr || std::abs(known->setting.speed - failed) > 1.0) << i;
    } else {
      const double speed = 1000.0 + 20.0 * (i % 30);
      memory.keep(speed_at(place, speed));
      ASSERT_NE(memory.recall(place), nullptr) << i;
      ASSERT_EQ(memory.recall(place)->setting.speed, speed);
    }
  }
}

}  // namespace
}  // namespace stillcut
