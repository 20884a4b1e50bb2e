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
  EXPECT_EQ(margin_at(Prediction{&diagram, nullptr, 1e-3, 1.0}, speed), 0.0);
  EXPECT_EQ(safe_margin_at(Prediction{&diagram, nullptr, 1e-3, 1.0}, speed), 0.0);
  const LobeDiagram none;
  for (const Prediction& p :
       {Prediction{}, Prediction{nullptr, nullptr, 1e-3, 1.0}, Prediction{&none, &none, 1e-3, 1.0},
        Prediction{&diagram, nullptr, kNaN, 1.0}, Prediction{&diagram, nullptr, 0.0, 1.0}}) {
    EXPECT_TRUE(std::isnan(margin_at(p, speed)));
    EXPECT_TRUE(std::isnan(safe_margin_at(p, speed)));
  }
  for (const double outside : {rpm_to_rad_s(5000), rpm_to_rad_s(13000), 0.0, -speed, kNaN, kInfinity}) {
    EXPECT_TRUE(std::isnan(margin_at(Prediction{&diagram, nullptr, 1e-3, 1.0}, outside)));
    EXPECT_TRUE(std::isnan(safe_margin_at(Prediction{&diagram, nullptr, 1e-3, 1.0}, outside)));
  }
}

TEST(PredictedMargin, LobesLieAtSpeedsHigherByTheScale) {
  ChoiceCases cases{2};
  for (int i = 0; i < 2000; ++i) {
    const SpindleLimits spindle = cases.limits().spindle;
    KeptPrediction p;
    p.here = cases.diagram(spindle);
    p.frequency_scale = cases.between(0.94, 1.06);
    const LobePoint& point = p.here->points[static_cast<std::size_t>(cases.whole(0, p.here->point_count - 1))];
    const double limit = std::isnan(point.depth_limit) ? 0.0 : point.depth_limit;
    EXPECT_EQ(margin_at(p.view(), point.speed * p.frequency_scale), limit / p.axial_depth - 1.0);
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
      const double reach = kReachKnown + (p.frequency_scale == 1.0 ? d->speed_scatter : 0.0);
      double least = kNaN;
      const auto look = [&](double there) {
        const double limit = depth_limit_at(*d, there / p.frequency_scale);
        if (!std::isnan(limit)) least = std::isnan(least) ? limit : std::min(least, limit);
      };
      for (int k = 0; k <= 400; ++k) look(speed * (1.0 - reach + 2.0 * reach * k / 400.0));
      for (int k = 0; k < d->point_count; ++k) {
        const double there = d->points[static_cast<std::size_t>(k)].speed * p.frequency_scale;
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

// What was heard says where the lobes lie better than the map does.
TEST(SafeMargin, AHeardScaleReplacesTheScatterOfTheSpeeds) {
  const SpindleLimits spindle = spindle_6000_to_12000();
  LobeDiagram diagram = diagram_of(std::vector<double>(61, 2.0), spindle);
  diagram.points[34].depth_limit = 0.5e-3;  // 9400 rpm
  diagram.speed_scatter = 0.06;
  Prediction p{&diagram, nullptr, 1e-3, 1.0};
  EXPECT_NEAR(safe_margin_at(p, rpm_to_rad_s(9000)), -0.5, 1e-12);
  p.frequency_scale = 1.021;  // the dip at 9597 rpm
  EXPECT_NEAR(safe_margin_at(p, rpm_to_rad_s(9000)), 1.0, 1e-12);
  EXPECT_NEAR(safe_margin_at(p, rpm_to_rad_s(9597)), -0.5, 1e-12);
}

TEST(HeardFrequencyScale, IsTheRatioBetweenTwoAndSixPerCentAndOneElsewhere) {
  const LobeDiagram diagram = diagram_at_700_hz();
  const double speed = rpm_to_rad_s(8000);
  for (double ratio = 0.8; ratio < 1.2; ratio += 0.0013) {
    const double off = std::abs(ratio - 1.0);
    const double scale = heard_frequency_scale(diagram, speed, 700.0 * ratio);
    if (off > 0.02 && off < 0.06) {
      EXPECT_NEAR(scale, ratio, 1e-12);
    } else {
      EXPECT_EQ(scale, 1.0);
    }
  }
}

TEST(HeardFrequencyScale, IsOneWhereNothingIsHeardOrPredicted) {
  const double speed = rpm_to_rad_s(8000), heard_hz = 730.0;
  const LobeDiagram good = diagram_at_700_hz();
  ASSERT_NE(heard_frequency_scale(good, speed, heard_hz), 1.0);
  for (const double nothing : {kNaN, kInfinity, 0.0, -730.0})
    EXPECT_EQ(heard_frequency_scale(good, speed, nothing), 1.0);
  for (const double outside : {rpm_to_rad_s(5000), rpm_to_rad_s(13000), kNaN})
    EXPECT_EQ(heard_frequency_scale(good, outside, heard_hz), 1.0);
  EXPECT_EQ(heard_frequency_scale({}, speed, heard_hz), 1.0);
  LobeDiagram changing = good;  // another mode chatters from 9000 rpm on: in between neither is predicted
  changing.points[1].chatter_frequency_hz = 750.0;
  EXPECT_EQ(heard_frequency_scale(changing, speed, heard_hz), 1.0);
  LobeDiagram stable = good;
  stable.points[0] = {stable.points[0].speed, kInfinity, kNaN};
  EXPECT_EQ(heard_frequency_scale(stable, speed, heard_hz), 1.0);
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
