#include "rt/predicted_margin.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "dsp/numbers.hpp"
#include "tests/rt/choice_cases.hpp"
#include "tests/rt/monitor_script.hpp"

namespace stillcut {
namespace {

// Chatter at 700 Hz from 6000 to 12000 rpm.
LobeDiagram diagram_at_700_hz() {
  LobeDiagram diagram = diagram_of({1, 1, 1}, spindle_6000_to_12000());
  for (std::size_t i = 0; i < 3; ++i) diagram.points[i].chatter_frequency_hz = 700.0;
  return diagram;
}

constexpr double kReachKnown = 0.01;  // relative; no speed in step is known better

TEST(PredictedMargin, IsTheWorseOfHereAndAhead) {
  ChoiceCases cases{1};
  int ahead_is_worse = 0;
  for (int i = 0; i < 2000; ++i) {
    const SpindleLimits spindle = cases.limits().spindle;
    KeptPrediction p;
    p.here = cases.diagram(spindle);
    p.ahead = cases.diagram(spindle);
    const double speed = cases.between(spindle.min_speed * 1.1, std::max(spindle.max_speed, spindle.min_speed * 1.11));
    const double here = margin_at(*p.here, speed, p.axial_depth), ahead = margin_at(*p.ahead, speed, p.axial_depth);
    if (std::isnan(here) || std::isnan(ahead)) continue;
    EXPECT_EQ(margin_at(p.view(), speed), ahead < here ? ahead : here);
    ahead_is_worse += ahead < here ? 1 : 0;
    KeptPrediction only_ahead = p;
    only_ahead.here.reset();
    EXPECT_EQ(margin_at(only_ahead.view(), speed), ahead);
    only_ahead.here = LobeDiagram{};  // not valid: as none
    EXPECT_EQ(margin_at(only_ahead.view(), speed), ahead);
  }
  EXPECT_GT(ahead_is_worse, 100);
}

TEST(PredictedMargin, IsUnknownWithoutADiagramADepthOrInsideOfNone) {
  const SpindleLimits spindle = spindle_6000_to_12000();
  const LobeDiagram diagram = diagram_of({1, 1, 1}, spindle);
  const double speed = rpm_to_rad_s(9000);
  EXPECT_EQ(margin_at(Prediction{&diagram, nullptr, 1e-3}, speed), 0.0);
  EXPECT_EQ(safe_margin_at(Prediction{&diagram, nullptr, 1e-3}, speed), 0.0);
  const LobeDiagram none;
  for (const Prediction& p : {Prediction{}, Prediction{nullptr, nullptr, 1e-3}, Prediction{&none, &none, 1e-3},
                              Prediction{&diagram, nullptr, kNaN}, Prediction{&diagram, nullptr, 0.0}}) {
    EXPECT_TRUE(std::isnan(margin_at(p, speed)));
    EXPECT_TRUE(std::isnan(safe_margin_at(p, speed)));
  }
  for (const double outside : {rpm_to_rad_s(5000), rpm_to_rad_s(13000), 0.0, -speed, kNaN, kInfinity}) {
    EXPECT_TRUE(std::isnan(margin_at(Prediction{&diagram, nullptr, 1e-3}, outside)));
    EXPECT_TRUE(std::isnan(safe_margin_at(Prediction{&diagram, nullptr, 1e-3}, outside)));
  }
}

// Looked for at many speeds, and at all those of the diagram.
TEST(SafeMargin, IsTheLeastInReachWithLimitsLowerByTheirScatter) {
  ChoiceCases cases{3};
  int lower = 0;
  for (int i = 0; i < 3000; ++i) {
    const CompensationLimits limits = cases.limits();
    KeptPrediction p = random_prediction(cases, limits.spindle);
    p.axial_depth = 1e-3;
    const double speed = cases.speed_in(limits);
    double wanted = kNaN;
    for (const LobeDiagram* d : {p.view().here, p.view().ahead}) {
      if (d == nullptr) continue;
      const double reach = kReachKnown + d->speed_scatter;
      double least = kNaN;
      const auto look = [&](double there) {
        const double limit = depth_limit_at(*d, there);
        if (!std::isnan(limit)) least = std::isnan(least) ? limit : std::min(least, limit);
      };
      for (int k = 0; k <= 400; ++k) look(speed * (1.0 - reach + 2.0 * reach * k / 400.0));
      for (int k = 0; k < d->point_count; ++k) {
        const double there = d->points[static_cast<std::size_t>(k)].speed;
        if (std::abs(there - speed) <= reach * speed) look(there);
      }
      const double margin = least * (1.0 - d->depth_scatter) / 1e-3 - 1.0;
      if (!std::isnan(margin)) wanted = std::isnan(wanted) ? margin : std::min(wanted, margin);
    }
    const double safe = safe_margin_at(p.view(), speed), margin = margin_at(p.view(), speed);
    ASSERT_EQ(std::isnan(safe), std::isnan(wanted));
    if (std::isnan(safe)) continue;
    if (std::isinf(wanted)) {
      EXPECT_EQ(safe, wanted);
    } else {
      EXPECT_NEAR(safe, wanted, 1e-12 * (2.0 + std::abs(wanted))) << i;
    }
    EXPECT_FALSE(safe > margin + 1e-12);
    lower += safe < margin - 0.01 ? 1 : 0;
  }
  EXPECT_GT(lower, 500);
}

TEST(BaseFrequency, ASidebandLeadsBackToTheChatterAndAnythingElseIsLeftAsHeard) {
  LobeDiagram diagram = diagram_at_700_hz();
  const double speed = rpm_to_rad_s(9000), passing_hz = 300.0;  // of two teeth
  for (const double chatter_hz : {690.0, 700.0, 715.0})
    for (const int j : {-2, -1, 0, 1, 2, 5})
      EXPECT_NEAR(base_frequency(diagram, speed, 2, chatter_hz + j * passing_hz), chatter_hz, 1e-9);
  for (const double other_hz : {850.0, 1150.0, 540.0}) EXPECT_EQ(base_frequency(diagram, speed, 2, other_hz), other_hz);
  diagram.modes[0].frequency_hz = 1000.0;  // a mode of its own there: heard as it is
  diagram.mode_count = 1;
  EXPECT_EQ(base_frequency(diagram, speed, 2, 1000.0), 1000.0);
}

TEST(BaseFrequency, WithoutAPredictionOrAToothPassingItIsAsHeard) {
  const LobeDiagram diagram = diagram_at_700_hz();
  const double speed = rpm_to_rad_s(9000);
  EXPECT_EQ(base_frequency({}, speed, 2, 1000.0), 1000.0);
  EXPECT_EQ(base_frequency(diagram, speed, 0, 1000.0), 1000.0);
  for (const double bad : {0.0, -speed, kNaN, kInfinity, rpm_to_rad_s(20000)})
    EXPECT_EQ(base_frequency(diagram, bad, 2, 1000.0), 1000.0);
  EXPECT_TRUE(std::isnan(base_frequency(diagram, speed, 2, kNaN)));
}

TEST(Explains, AFrequencyNearAModeOrNearThePredictedChatterIsKnown) {
  LobeDiagram diagram = diagram_at_700_hz();
  diagram.modes[0].frequency_hz = 20.0;
  diagram.modes[1].frequency_hz = 1200.0;
  diagram.modes[2].frequency_hz = 3000.0;  // beyond the count
  diagram.mode_count = 2;
  const double speed = rpm_to_rad_s(8000);
  for (const double known : {20.0, 700.0, 1200.0}) {
    EXPECT_TRUE(explains(diagram, speed, known * 1.05));
    EXPECT_TRUE(explains(diagram, speed, known * 0.95));
    EXPECT_FALSE(explains(diagram, speed, known * 1.07));
    EXPECT_FALSE(explains(diagram, speed, known * 0.93));
  }
  EXPECT_FALSE(explains(diagram, speed, 3000.0));
  EXPECT_FALSE(explains(diagram, speed, kNaN));
  EXPECT_FALSE(explains(diagram, rpm_to_rad_s(13000), 700.0));
  EXPECT_TRUE(explains(diagram, rpm_to_rad_s(13000), 1200.0));
  diagram.mode_count = 1000;  // more than there is room for
  EXPECT_FALSE(explains(diagram, speed, 5000.0));
}

}  // namespace
}  // namespace stillcut
