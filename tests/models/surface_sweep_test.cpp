// Swept surfaces against closed forms: scallops, feed marks, runout, inclination, the order of passes.
#include "models/surface_sweep.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "tests/models/swept_cuts.hpp"

namespace stillcut::test {
namespace {

// Mean deviation of arcs of radius `radius`, `width` apart: a parabola's, which circles of this size are within 1e-3.
double arc_deviation(double radius, double width) {
  return 4.0 / (9.0 * std::sqrt(3.0)) * width * width / (8.0 * radius);
}

// An inclined ball's edge passes a point of the surface like a straight line, `normal` its way. As the tool travels
// meanwhile, the marks are a little wider or narrower than the feed per tooth.
double mark_width(const SweptCut& c) {
  const CutterMotion motion = cutter_motion(c.tool, c.cut);
  const double sine = std::sin(motion.inclination()), edge_speed = c.cut.spindle_speed * 0.5 * c.tool.diameter * sine;
  return c.cut.feed_per_tooth / (1.0 + motion.feed_rate / edge_speed * motion.orientation(1, 2) / sine);
}

double range(const std::vector<double>& heights) {
  const auto [low, high] = std::minmax_element(heights.begin(), heights.end());
  return *high - *low;
}

// Fails where an edge is placed wrongly, a patch is left out, or a height is not the patch's.
TEST(SurfaceSweep, ScallopsAndFeedMarksAreTheArcsOfTheBall) {
  struct Case {
    double feed, step_over, lead_deg, tilt_deg;
  };
  for (const Case& k : {Case{0.1e-3, 0.4e-3, 10, 0}, Case{0.1e-3, 0.4e-3, 0, 10}, Case{0.1e-3, 0.4e-3, 0, -10},
                        Case{0.1e-3, 0.4e-3, -15, 20}, Case{0.1e-3, 0.6e-3, 30, 0}, Case{0.05e-3, 0.2e-3, 10, 5},
                        Case{0.05e-3, 0.4e-3, 5, 10}, Case{0.2e-3, 0.8e-3, 20, -20}}) {
    SweptCut c;
    c.aligned = true;
    c.cut.feed_per_tooth = k.feed;
    c.cut.step_over = k.step_over;
    c.cut.lead = deg_to_rad(k.lead_deg);
    c.cut.tilt = deg_to_rad(k.tilt_deg);
    c.along = 20.0 * mark_width(c);  // enough for the line through them to lie level
    c.across = 2.0 * k.step_over;
    c.spacing = k.feed / 40.0;
    const HeightMap map = swept(c);
    const std::string name =
        testing::PrintToString(std::vector{1e3 * k.feed, 1e3 * k.step_over, k.lead_deg, k.tilt_deg});
    const double along = arc_deviation(4e-3, mark_width(c)), across = arc_deviation(4e-3, k.step_over);
    EXPECT_NEAR(ra_along(map), along, 0.01 * along) << name;
    EXPECT_NEAR(ra_across(map), across, 0.01 * across) << name;
    const double half = 0.5 * k.step_over, mark = 0.5 * mark_width(c);
    const double height = 4e-3 - std::sqrt(16e-6 - half * half - mark * mark);
    EXPECT_NEAR(range(map.heights), height, 0.01 * height) << name;
  }
}

// The tip of an upright ball has no speed, and yet the surface is the sphere's: nowhere below it, and under the tool's
// track as low as its marks let it be.
TEST(SurfaceSweep, UprightBallLeavesItsEnvelope) {
  SweptCut c;
  c.tool.helix = deg_to_rad(30);
  const HeightMap map = swept(c);
  const double mark = 0.1e-3 * 0.1e-3 / (8 * 4e-3);
  for (std::size_t j = 0; j < map.across; ++j) {
    const double y = std::remainder(static_cast<double>(j) * map.spacing_across, 0.4e-3);
    const double envelope = 4e-3 - std::sqrt(16e-6 - y * y);
    const std::vector<double> row = row_along(map, j);
    const double lowest = *std::min_element(row.begin(), row.end());
    EXPECT_GE(lowest, envelope - 1e-12);
    // Where the edge stands still for a moment (f_z N / 2 pi beside the track) its marks are further apart.
    EXPECT_LE(lowest, envelope + (std::abs(y) > 0.1e-3 ? 2e-9 : mark)) << y;
  }
  EXPECT_NEAR(range(row_along(map, 0)), 0.0, 1e-12);  // the tip itself draws the track
}

// Teeth at two heights d = 2 rho sin(kappa) apart: the deeper one's arcs take from the other's, and all of them from d
// = f_z^2/(2R) on. Then the interval is two feeds.
TEST(SurfaceSweep, RunoutLetsEverySecondToothMark) {
  SweptCut c;
  c.cut.lead = deg_to_rad(10);
  c.spacing = 1e-6;
  c.across = 10e-6;
  c.along = 0.6e-3;
  const double feed = c.cut.feed_per_tooth, radius = 4e-3, sine = std::sin(c.cut.lead);
  const double all = feed * feed / (4.0 * radius * sine);  // rho from which one tooth alone marks
  for (const double part : {0.0, 0.25, 0.5, 0.75, 1.1, 4.0}) {
    c.tool.runout = part * all;
    const double apart = 2.0 * c.tool.runout * sine;
    // The offset also takes both teeth apart along the feed, so that one gap is longer than the other.
    double peak = 0.0;
    for (const double side : {-1.0, 1.0}) {
      const double gap = feed + side * 2.0 * c.tool.runout * std::cos(c.cut.lead);
      peak = std::max(peak, 0.5 * gap + apart * radius / gap);
    }
    peak = std::min(feed, peak);
    const double height = peak * peak / (2.0 * radius);
    EXPECT_NEAR(range(row_along(swept(c), 0)), height, 0.01 * height) << part;
  }
}

// An end mill stood upright leaves a plane; inclined along the feed the ellipse of its corner; inclined across it teeth
// of a saw, as steep as the inclination.
TEST(SurfaceSweep, EndMillLeavesThePlaneOrTheEllipseOfItsCorner) {
  SweptCut c;
  c.tool.shape = ToolShape::end;
  c.tool.diameter = 2e-3;
  c.cut.feed_per_tooth = 0.02e-3;
  c.cut.step_over = 1e-3;
  c.across = 2e-3;
  c.along = 0.06e-3;
  EXPECT_EQ(range(swept(c).heights), 0.0);
  for (const double lead_deg : {-3.0, 2.0}) {
    c.cut.lead = deg_to_rad(lead_deg);
    const HeightMap map = swept(c);
    const double between = std::sin(std::abs(c.cut.lead)) * map.spacing_along;  // of the bottom, from point to point
    for (std::size_t j = 0; j < map.across; j += 10) {
      const double y = std::remainder(static_cast<double>(j) * map.spacing_across, 1e-3);
      const double arc = std::sin(std::abs(c.cut.lead)) * (1e-3 - std::sqrt(1e-6 - y * y));
      const std::vector<double> row = row_along(map, j);
      EXPECT_NEAR(*std::min_element(row.begin(), row.end()), arc, 0.01 * arc + between) << lead_deg << ' ' << y;
    }
  }
  c.cut.lead = 0.0;
  c.cut.tilt = deg_to_rad(2.0);
  const double saw = 1e-3 * std::tan(c.cut.tilt);
  EXPECT_NEAR(range(row_across(swept(c), 5)), saw, 0.01 * saw);
}

// Where the edge crosses the track: the tooth then points at the contact. In zig-zag the tool goes back on every second
// track, with the phase that the spindle has there.
TEST(SurfaceSweep, MarksLieWhereTheSpindlesPhasePutsThem) {
  for (const PathKind path : {PathKind::unidirectional, PathKind::zigzag}) {
    SweptCut c;
    c.cut.path = path;
    c.cut.lead = deg_to_rad(15);
    c.spacing = 2e-6;
    const CutterMotion motion = cutter_motion(c.tool, c.cut);
    const HeightMap map = swept(c);
    int marks = 0, reversed = 0;
    for (const CutterPass& pass : passes_over(motion, c.cut, c.along, c.across)) {
      if (pass.across < -1e-9 || pass.across > c.across + 1e-9) continue;
      reversed += pass.reversed;
      const auto row = row_along(map, static_cast<std::size_t>(std::lround(pass.across / map.spacing_across)));
      const Eigen::Vector3d contact = -motion.orientation.row(2).transpose();
      const double tooth = std::atan2(contact.x(), contact.y());
      for (std::size_t i = 20; i + 20 < row.size(); ++i) {
        if (!(row[i] < row[i - 1] && row[i] <= row[i + 1])) continue;
        const double x = static_cast<double>(i) * map.spacing_along;
        const double time = (x - pass.begin) * (pass.reversed ? -1.0 : 1.0) / motion.feed_rate;
        const double off = std::remainder(pass.angle + motion.spindle_speed * time - tooth, kTwoPi / 2);
        EXPECT_LT(std::abs(off) / motion.spindle_speed * motion.feed_rate, 1.01 * map.spacing_along);
        ++marks;
      }
    }
    EXPECT_GE(marks, 3 * 8);
    EXPECT_EQ(reversed > 0, path == PathKind::zigzag);
  }
}

std::string refusal(const SweptCut& c) {
  try {
    (void)swept(c);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(SurfaceSweep, RefusesWhatLeavesNoSurfaceOfItsOwn) {
  const SweptCut sound;
  EXPECT_EQ(refusal(sound), "");
  SweptCut c = sound;
  c.spacing = 25e-6;
  EXPECT_THAT(refusal(c), testing::HasSubstr("at most 0.02 mm"));
  const CutterMotion motion = cutter_motion(c.tool, c.cut);
  EXPECT_NO_THROW(SurfaceSweep(motion, c.cut, 25e-6, 25e-6, true));
  c = sound;
  c.cut.axial_depth = -0.1e-3;
  EXPECT_THAT(refusal(c), testing::HasSubstr("axial depth"));
  c = sound;
  c.cut.radial_depth = -0.1e-3;
  EXPECT_THAT(refusal(c), testing::HasSubstr("step-over"));
  c = sound;
  c.cut.step_over = 9e-3;
  EXPECT_THAT(refusal(c), testing::HasSubstr("8 mm that the tool is wide"));
  c = sound;
  c.cut.axial_depth = 4e-6;  // the ridges are 5 um high
  EXPECT_THAT(refusal(c), testing::HasSubstr("ridges"));
  for (const double tilt_deg : {88.0, 91.0, 180.0}) {
    c = sound;
    c.cut.tilt = deg_to_rad(tilt_deg);
    EXPECT_THAT(refusal(c), testing::HasSubstr("tilt and lead")) << tilt_deg;
  }
}

}  // namespace
}  // namespace stillcut::test
