// The truth of chatter on motions that are known in closed form.
#include "models/chatter_truth.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "models/machining.hpp"

namespace stillcut {
namespace {

constexpr double kTruthRate = 20e3;             // Hz
constexpr double kTruthSpeed = 140.0 * kTwoPi;  // rad/s

ChatterTruth truth_of(
    double duration, const std::function<Eigen::Vector3d(double)>& motion,
    const std::function<bool(double)>& disturbed = [](double) { return false; }) {
  ChatterTruth truth;
  for (int i = 0; i < static_cast<int>(duration * kTruthRate); ++i) {
    const double t = i / kTruthRate;
    truth.add(t, kTruthSpeed * t, motion(t), disturbed(t));
  }
  return truth;
}

Eigen::Vector3d along_x(double x) { return {x, 0.0, 0.0}; }
bool just_after(double time, double moment) { return time >= moment && time < moment + 1e-3; }

TEST(ChatterTruth, IsNotWhatRepeatsWithTheSpindleHoweverLarge) {
  const auto runout = [](double t) {
    return along_x(1e-4 * std::sin(kTruthSpeed * t) + 5e-5 * std::cos(6.0 * kTruthSpeed * t));
  };
  EXPECT_TRUE(truth_of(2.0, runout).spells().empty());
}

TEST(ChatterTruth, IsNotRingingThatDecays) {
  // A robot's mode after an entry, and a tool's after a knock, both far above the limit.
  const auto ringing = [](double t) {
    const double slow = t < 0.5 ? 0.0 : std::exp(-2.2 * (t - 0.5)) * std::sin(kTwoPi * 11.0 * (t - 0.5));
    const double fast = t < 1.5 ? 0.0 : std::exp(-60.0 * (t - 1.5)) * std::sin(kTwoPi * 757.0 * (t - 1.5));
    return along_x(2e-4 * slow + 5e-5 * fast);
  };
  const auto spells =
      truth_of(4.0, ringing, [](double t) { return just_after(t, 0.5) || just_after(t, 1.5); }).spells();
  EXPECT_TRUE(spells.empty());
}

TEST(ChatterTruth, BeginsWhereGrowthCrossesTheLimit) {
  // Grows from 0.1 um with 20/s: crosses 3 um 0.17 s after its start at 1 s, saturates at 40 um.
  const auto growing = [](double t) {
    const double amplitude = t < 1.0 ? 0.0 : std::min(1e-7 * std::exp(20.0 * (t - 1.0)), 4e-5);
    return along_x(amplitude * std::sin(kTwoPi * 757.0 * t));
  };
  const auto spells = truth_of(3.0, growing).spells();
  ASSERT_EQ(spells.size(), 1U);
  EXPECT_NEAR(spells[0].start, 1.0 + std::log(30.0) / 20.0, 0.02);
  EXPECT_FALSE(spells[0].died_down);
  EXPECT_NEAR(spells[0].frequency_hz, 757.0, 1.0);
  EXPECT_NEAR(spells[0].peak, 4e-5, 2e-5);
}

TEST(ChatterTruth, HearsARobotModeAndItsEnd) {
  const auto swinging = [](double t) {
    const bool on = t > 1.0 && t < 3.0;
    return Eigen::Vector3d(on ? 1e-4 * std::sin(kTwoPi * 12.0 * t) : 0.0, on ? 5e-5 * std::cos(kTwoPi * 12.0 * t) : 0.0,
                           0.0);
  };
  const auto spells = truth_of(4.0, swinging).spells();
  ASSERT_EQ(spells.size(), 1U);
  EXPECT_NEAR(spells[0].start, 1.0, 0.02);
  EXPECT_NEAR(spells[0].end, 3.0, 0.1);
  EXPECT_TRUE(spells[0].died_down);
  EXPECT_NEAR(spells[0].frequency_hz, 12.0, 1.0);
}

TEST(ChatterTruth, StepsOfThePeriodicPartAreNoChatter) {
  const auto stepped = [](double t) { return along_x((t < 1.0 ? 2e-5 : 8e-5) * std::sin(2.0 * kTruthSpeed * t)); };
  EXPECT_TRUE(truth_of(3.0, stepped, [](double t) { return just_after(t, 1.0); }).spells().empty());
}

}  // namespace
}  // namespace stillcut
