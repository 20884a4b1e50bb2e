#include "tools/plot_lobes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "dsp/numbers.hpp"

namespace stillcut {
namespace {

// Six speeds, 1000 to 6000 rpm: unstable throughout, a limit, two without, and two limits.
LobeStudy study_of(std::size_t curves) {
  LobeStudy study;
  for (int i = 1; i <= 6; ++i) study.question.speeds.push_back(rpm_to_rad_s(1000.0 * i));
  LobeCurve curve;
  curve.predicted.posture.id = "here";
  curve.limits = {{kNaN, kNaN}, {1e-3, 600}, {kInfinity, kNaN}, {kInfinity, kNaN}, {3e-3, 700}, {2e-3, 800}};
  curve.coupling = {2.5e-3, kTwoPi * 14.0};
  curve.cut.spindle_speed = rpm_to_rad_s(2500);
  curve.cut.axial_depth = 1e-3;
  study.curves.assign(curves, curve);
  return study;
}

TEST(LobeFigure, ShadesSpeedsWithoutALimitAndDrawsNoNumberThere) {
  const plot::Panel panel = lobe_figure(study_of(1)).panels.at(0);
  ASSERT_EQ(panel.lines.size(), 1u);
  const std::vector<double>& depths = panel.lines[0].y;
  for (const std::size_t i : {0u, 2u, 3u}) EXPECT_TRUE(std::isnan(depths[i])) << i;
  EXPECT_DOUBLE_EQ(depths[4], 3.0);
  ASSERT_EQ(panel.bands.size(), 2u);
  EXPECT_NEAR(panel.bands[0].begin, 1000, 1e-9);
  EXPECT_NEAR(panel.bands[0].end, 1500, 1e-9);
  EXPECT_EQ(panel.bands[0].label, "unstable at every depth");
  EXPECT_NEAR(panel.bands[1].begin, 2500, 1e-9);
  EXPECT_NEAR(panel.bands[1].end, 4500, 1e-9);
  EXPECT_EQ(panel.bands[1].label, "no limit up to 20 mm");
  // The lone limit at 2000 rpm, to which no line leads, is a point.
  EXPECT_NEAR(panel.points.at(0).x.at(0), 2000, 1e-9);
  EXPECT_NEAR(panel.points.at(0).y.at(0), 1.0, 1e-12);
}

TEST(LobeFigure, MarksModeCouplingWithItsFrequency) {
  LobeStudy study = study_of(1);
  const plot::Panel panel = lobe_figure(study).panels.at(0);
  ASSERT_EQ(panel.limits.size(), 1u);
  EXPECT_DOUBLE_EQ(panel.limits[0].y, 2.5);
  EXPECT_THAT(panel.limits[0].text, ::testing::HasSubstr("14 Hz"));
  study.curves[0].coupling = {kInfinity, kNaN};
  const plot::Figure without = lobe_figure(study);
  EXPECT_TRUE(without.panels[0].limits.empty());
  EXPECT_THAT(without.subtitle, ::testing::HasSubstr("none up to 20 mm"));
  study.curves[0].coupling = {15e-3, kTwoPi * 14.0};  // far above the lobes: said, not drawn
  EXPECT_TRUE(lobe_figure(study).panels[0].limits.empty());
  EXPECT_LT(lobe_figure(study).panels[0].y.max, 4.0);
  EXPECT_THAT(lobe_figure(study).subtitle, ::testing::HasSubstr("15 mm"));
}

TEST(LobeFigure, SeveralCurvesHaveTheirOwnColoursNamesAndStrips) {
  const plot::Panel panel = lobe_figure(study_of(3)).panels.at(0);
  ASSERT_EQ(panel.lines.size(), 3u);
  EXPECT_EQ(panel.lines[2].label, "here, 0°");
  EXPECT_NE(panel.lines[0].color.red, panel.lines[1].color.red);
  ASSERT_EQ(panel.bands.size(), 6u);
  EXPECT_LT(panel.bands[0].top, 0.1);     // unstable: along the bottom
  EXPECT_GT(panel.bands[1].bottom, 0.9);  // no limit: along the top
  EXPECT_LE(panel.bands[3].top, panel.bands[1].bottom);
}

TEST(LobeFigure, ShowsCutsByTheirVerdictAndTheCellsOwn) {
  const std::vector<MeasuredCut> cuts{{{2, 1500, 1.0}, Verdict::stable},
                                      {{3, 2500, 4.0}, Verdict::unstable},
                                      {{4, 7000, 2.0}, Verdict::near_limit},
                                      {{5, 1600, 0.5}, Verdict::stable}};
  const plot::Figure figure = lobe_figure(study_of(1), cuts);
  const auto& points = figure.panels.at(0).points;
  ASSERT_EQ(points.size(), 5u);  // the lone limit, the cell's cut, three verdicts
  EXPECT_EQ(points[1].label, "the cell's cut");
  EXPECT_EQ(points[2].label, "measured: stable");
  EXPECT_EQ(points[2].x.size(), 2u);
  EXPECT_EQ(points[3].label, "measured: marginal");
  EXPECT_EQ(points[4].label, "measured: chatter");
  EXPECT_EQ(figure.x.max, 7000);  // no cut is left out
  EXPECT_GT(figure.panels[0].y.max, 4.0);
}

TEST(LobeFigure, DrawsTheBandOfConfidenceInsideThePicture) {
  LobeStudy study = study_of(1);
  study.question.confidence = Confidence{};
  study.curves[0].bands = {{0.0, 0.0},        {5e-4, kInfinity}, {1e-3, kInfinity},
                           {1e-3, kInfinity}, {2e-3, 4e-3},      {1e-3, 3e-3}};
  const plot::Panel panel = lobe_figure(study).panels.at(0);
  ASSERT_EQ(panel.areas.size(), 1u);
  EXPECT_THAT(panel.areas[0].label, ::testing::HasSubstr("95 %"));
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_LE(panel.areas[0].low[i], panel.areas[0].high[i]);
    EXPECT_LE(panel.areas[0].high[i], panel.y.max);
  }
}

TEST(LobeFigure, HoldsWhereNothingHasALimit) {
  for (const double depth : {kInfinity, kNaN}) {
    LobeStudy study = study_of(2);
    for (LobeCurve& curve : study.curves) curve.limits.assign(6, {depth, kNaN});
    const plot::Figure figure = lobe_figure(study);
    EXPECT_EQ(figure.panels.size(), 1u);  // no frequency to show
    EXPECT_EQ(figure.panels[0].bands.size(), 2u);
  }
}

}  // namespace
}  // namespace stillcut
