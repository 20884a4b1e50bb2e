// The picture of a studied surface: heights, profiles and spectra, alone and beside a measured map.
#include "tools/plot_surface_study.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/models/surface_maps.hpp"

namespace stillcut {
namespace {

using ::testing::HasSubstr;

HeightMap waves(std::size_t points, double height) {
  return surface_of(points, points / 2, 10e-6, 10e-6, [height](double x, double y) {
    return height * (std::sin(2.0 * std::numbers::pi * x / 0.1e-3) + std::cos(2.0 * std::numbers::pi * y / 0.2e-3));
  });
}

StudiedSurface studied(HeightMap map) {
  StudiedSurface study;
  study.tool = {.shape = ToolShape::ball, .diameter = 8e-3, .teeth = 2, .pitch = {}};
  study.cut.spindle_speed = rpm_to_rad_s(6000);
  study.cut.feed_per_tooth = 0.1e-3;
  study.cut.radial_depth = 0.2e-3;
  study.map = std::move(map);
  return study;
}

TEST(SurfaceStudyFigure, ShowsHeightsProfilesAndSpectra) {
  const plot::Figure figure = surface_study_figure(studied(waves(100, 1e-6)), nullptr);
  EXPECT_EQ(figure.title, "8 mm ball end, 6000 rpm, feed 0.1 mm a tooth, step-over 0.2 mm");
  ASSERT_EQ(figure.panels.size(), 5u);
  EXPECT_TRUE(figure.panels[0].image);
  EXPECT_THAT(figure.panels[0].title, HasSubstr("predicted:  S_a "));
  for (std::size_t i = 1; i < 5; ++i) EXPECT_EQ(figure.panels[i].lines.size(), 1u) << i;
  EXPECT_THAT(figure.panels[3].events.at(0).text, HasSubstr("every 0.1 mm"));
  EXPECT_EQ(surface_study_figure(studied(waves(6, 1e-6)), nullptr).panels.size(), 3u);  // too few for a spectrum
}

// Breaks where equal colours are different heights, and where the two cannot be told apart.
TEST(SurfaceStudyFigure, ShowsAMeasuredMapToTheSameScale) {
  const MeasuredSurface measured{.file = "part.sdf", .map = waves(80, 2e-6), .figures = {}};
  const plot::Figure figure = surface_study_figure(studied(waves(100, 1e-6)), &measured);
  ASSERT_EQ(figure.panels.size(), 6u);
  EXPECT_THAT(figure.panels[1].title, HasSubstr("measured: part.sdf:  S_a "));
  EXPECT_EQ(figure.panels[0].image->low, figure.panels[1].image->low);
  EXPECT_EQ(figure.panels[0].image->high, figure.panels[1].image->high);
  EXPECT_GT(figure.panels[0].image->high, 3.0);  // µm, of the higher one
  for (std::size_t i = 2; i < 6; ++i) {
    const plot::Panel& panel = figure.panels[i];
    ASSERT_EQ(panel.lines.size(), 2u) << i;
    EXPECT_EQ(panel.lines[0].label, "predicted");
    EXPECT_EQ(panel.lines[1].label, "measured: part.sdf");
    EXPECT_NE(panel.lines[0].color.red, panel.lines[1].color.red);
  }
}

}  // namespace
}  // namespace stillcut
