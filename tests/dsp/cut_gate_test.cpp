#include "dsp/cut_gate.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <utility>
#include <vector>

namespace stillcut {
namespace {

constexpr double kStep_s = 0.003;
constexpr double kSpeed = 6000.0 * std::numbers::pi / 30.0;

struct Gate {
  CutGate gate{CutGateSettings{}};
  std::vector<CutGate::Change> changes{};

  void hold(double level, double seconds, double speed = kSpeed) { hold(level, seconds, speed, level); }
  void hold(double level, double seconds, double speed, double whole) {
    for (double t = 0.0; t < seconds; t += kStep_s) {
      const auto change = gate.step(level, whole, speed, kStep_s);
      if (change != CutGate::Change::none) changes.push_back(change);
    }
  }
};

using Changes = std::vector<CutGate::Change>;
constexpr auto kEntered = CutGate::Change::entered, kLeft = CutGate::Change::left;

TEST(CutGate, GoesFromIdleThroughAirEntryCutAndExitBackToIdle) {
  Gate g;
  g.hold(0.1, 0.2, 0.0);
  EXPECT_EQ(g.gate.state(), State::idle);
  g.hold(1.0, 0.5);
  EXPECT_EQ(g.gate.state(), State::air);
  g.hold(5.0, 0.03);
  EXPECT_EQ(g.gate.state(), State::entry);
  g.hold(5.0, 1.0);
  EXPECT_EQ(g.gate.state(), State::cut);
  g.hold(1.0, 0.02);
  EXPECT_EQ(g.gate.state(), State::exit);
  g.hold(1.0, 0.1);
  EXPECT_EQ(g.gate.state(), State::air);
  g.hold(0.1, 0.1, 0.0);
  EXPECT_EQ(g.gate.state(), State::idle);
  EXPECT_EQ(g.changes, (Changes{kEntered, kLeft}));
}

TEST(CutGate, LeavesTheCutWhenTheSpindleStops) {
  Gate g;
  g.hold(1.0, 0.5);
  g.hold(5.0, 0.5);
  g.hold(5.0, 0.01, 0.0);
  EXPECT_EQ(g.gate.state(), State::idle);
  EXPECT_EQ(g.changes, (Changes{kEntered, kLeft}));
}

TEST(CutGate, IsNotMovedByASingleKnock) {
  Gate g;
  g.hold(1.0, 0.5);
  g.hold(50.0, 0.012);
  g.hold(1.0, 0.5);
  EXPECT_TRUE(g.changes.empty());
}

TEST(CutGate, DoesNotTakeASpindleThatRunsUpForACut) {
  Gate g;
  for (double t = 0.0; t < 1.0; t += kStep_s) g.hold(1.0 + 4.0 * t, kStep_s, kSpeed * (0.05 + t));
  EXPECT_TRUE(g.changes.empty());
  g.hold(5.0, 0.3, kSpeed);
  g.hold(15.0, 0.3, kSpeed);
  EXPECT_EQ(g.changes, Changes{kEntered});
}

TEST(CutGate, FollowsAQuieterSpindleAtOnceAndALouderOneSlowly) {
  Gate g;
  g.hold(2.0, 0.5);
  g.hold(1.0, 2.0);
  EXPECT_NEAR(g.gate.air_level(), 1.0, 0.01);
  g.hold(1.4, 2.0);
  EXPECT_LT(g.gate.air_level(), 1.1);
  EXPECT_TRUE(g.changes.empty());
}

TEST(CutGate, HasHysteresis) {
  Gate g;
  g.hold(1.0, 0.5);
  g.hold(1.5, 0.5);  // below the entry ratio
  EXPECT_TRUE(g.changes.empty());
  g.hold(3.0, 0.5);
  g.hold(1.5, 0.5);  // above the exit ratio
  EXPECT_EQ(g.changes, Changes{kEntered});
}

// What repeats with the spindle is forgotten only after some revolutions.
TEST(CutGate, LeavesTheCutByTheWholeLevelWhileThatOfTheSpindleLags) {
  Gate g;
  g.hold(1.0, 0.5);
  g.hold(5.0, 0.5);
  g.hold(5.0, 0.03, kSpeed, 1.0);
  EXPECT_EQ(g.changes, (Changes{kEntered, kLeft}));
}

TEST(CutGate, DoesNotLeaveTheCutByAWholeLevelThatNeverToldOfIt) {
  Gate g;
  g.hold(1.0, 0.5, kSpeed, 10.0);
  g.hold(5.0, 0.5, kSpeed, 11.0);
  EXPECT_EQ(g.changes, Changes{kEntered});
  g.hold(1.0, 0.03, kSpeed, 10.0);
  EXPECT_EQ(g.changes, (Changes{kEntered, kLeft}));
}

TEST(CutGate, EntersNoCutWithinSixRevolutionsOfAnExit) {
  for (const double rpm : {1200.0, 6000.0, 18000.0}) {
    const double speed = rpm * std::numbers::pi / 30.0, six_s = 360.0 / rpm;
    Gate g;
    g.hold(1.0, 1.0, speed);
    g.hold(5.0, 1.0, speed);
    g.hold(1.0, 0.017, speed);
    ASSERT_EQ(g.changes, (Changes{kEntered, kLeft})) << rpm;
    g.hold(5.0, six_s - 2.0 * kStep_s, speed);
    EXPECT_EQ(g.changes, (Changes{kEntered, kLeft})) << rpm;
    g.hold(5.0, 0.03, speed);
    EXPECT_EQ(g.changes, (Changes{kEntered, kLeft, kEntered})) << rpm;
  }
}

TEST(CutGate, BelievesChatter) {
  Gate g;
  g.hold(1.0, 0.5);
  EXPECT_EQ(g.gate.contact(), kEntered);
  EXPECT_EQ(g.gate.state(), State::cut);
  EXPECT_EQ(g.gate.contact(), CutGate::Change::none);
}

}  // namespace
}  // namespace stillcut
