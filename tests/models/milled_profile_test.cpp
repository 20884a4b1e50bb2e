// Roughness of walls and floors whose profile is known.
#include "models/milled_profile.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "dsp/numbers.hpp"
#include "models/floor_heights.hpp"
#include "models/surface_sweep.hpp"
#include "models/wall_heights.hpp"

namespace stillcut {
namespace {

constexpr double kWallRadius = 10e-3;
const double kArcRa = 4.0 / (9.0 * std::sqrt(3.0));  // of the height of a parabola's arcs
const double kArcRq = 2.0 / (3.0 * std::sqrt(5.0));  // likewise

std::optional<ProfileRoughness> wall_roughness(const std::vector<ToothPass>& passes) {
  const MilledHeights heights = [&](double from, double spacing, std::size_t count) {
    return wall_heights(passes, kWallRadius, from, spacing, count);
  };
  if (passes.empty()) return mean_of(milled_lengths(heights, 0.0, 0.0));
  return mean_of(milled_lengths(heights, passes.front().along, passes.back().along));
}

// Fails with an arc of the wrong radius, with gaps between lengths, and with sums that are not the surface's.
TEST(MilledProfile, OfFeedMarksAloneIsTheirArcs) {
  constexpr double kFeed = 0.4e-3;
  std::vector<ToothPass> passes;
  for (int i = 0; i < 100; ++i) passes.push_back({i * kFeed, 0.0});
  const double height = kFeed * kFeed / (8.0 * kWallRadius);
  const auto r = wall_roughness(passes);
  ASSERT_TRUE(r);
  EXPECT_NEAR(r->ra, kFeed * kFeed / (18.0 * std::sqrt(3.0) * kWallRadius), 0.01 * height);
  EXPECT_NEAR(r->rq, kArcRq * height, 0.01 * height);
  EXPECT_NEAR(r->rt, height, 0.01 * height);
}

// A wave less curved than the tool is left as it is; the tool bridges the valleys of a sharper one.
TEST(MilledProfile, OfAGentleWaveIsTheWaves) {
  constexpr double kWave = 0.4e-3, kHigh = 1e-7;  // two waves a sampling length
  std::vector<ToothPass> passes;
  for (int i = 0; i < 4000; ++i)
    passes.push_back({i * 2e-6, kHigh * std::sin(2.0 * std::numbers::pi * i * 2e-6 / kWave)});
  EXPECT_NEAR(wall_roughness(passes).value().ra, 2.0 / std::numbers::pi * kHigh, 0.1 * kHigh);
}

TEST(MilledProfile, LeavesFormOut) {
  std::vector<ToothPass> passes;
  for (int i = 0; i < 500; ++i) passes.push_back({i * 20e-6, 1e-3 * i * 20e-6});  // a slope of 1 in 1000
  EXPECT_LT(wall_roughness(passes).value().ra, 5e-9);
}

TEST(MilledProfile, OfRunoutShowsOnlyTheToothThatReachesDeepest) {
  std::vector<ToothPass> both, deep;
  for (int i = 0; i < 200; ++i) {
    both.push_back({i * 50e-6, i % 2 == 0 ? 5e-6 : -5e-6});
    if (i % 2 == 0) deep.push_back({i * 50e-6, 5e-6});
  }
  EXPECT_NEAR(wall_roughness(both).value().ra, wall_roughness(deep).value().ra, 1e-9);
}

TEST(MilledProfile, OfAShortWallOrNoneIsUnknown) {
  EXPECT_FALSE(wall_roughness({}));
  EXPECT_FALSE(wall_roughness({{0.0, 0.0}, {50e-6, 0.0}}));
}

// The mean over the lengths that are known alone: fails where a gap in the wall counts as one.
TEST(MilledProfile, LeavesOutWhatWasNotCut) {
  std::vector<ToothPass> whole, with_gap;
  for (int i = 0; i < 400; ++i) {
    whole.push_back({i * 0.2e-3, 0.0});
    if (i < 100 || i > 120) with_gap.push_back(whole.back());
  }
  const double ra = wall_roughness(whole).value().ra;
  EXPECT_NEAR(wall_roughness(with_gap).value().ra, ra, 0.05 * ra);  // at its ends an arc is not cut by the next
}

// Fails where lengths are left out that were asked for, or all of them from the end.
TEST(MilledProfile, AreSpreadWhereFewAreAskedFor) {
  const MilledHeights flat = [](double, double, std::size_t count) { return std::vector<double>(count, 0.0); };
  const auto all = milled_lengths(flat, 1e-3, 81.1e-3), few = milled_lengths(flat, 1e-3, 81.1e-3, 30);
  ASSERT_EQ(all.size(), 100U);
  ASSERT_EQ(few.size(), 25U);
  for (std::size_t i = 0; i < few.size(); ++i) EXPECT_EQ(few[i].from, all[4 * i].from);
}

constexpr double kTrackStep = 1.0 / 25600.0, kTrackSpeed = 2.0 * std::numbers::pi * 100.0;  // s, rad/s

struct FloorCut {
  Tool tool{.shape = ToolShape::ball, .diameter = 8e-3, .teeth = 2, .pitch = {std::numbers::pi, std::numbers::pi}};
  Cut cut{.radial_depth = 0.4e-3, .axial_depth = 0.5e-3, .feed_per_tooth = 0.1e-3, .spindle_speed = kTrackSpeed};
};

double feed_rate_of(const FloorCut& f) { return 2.0 * f.cut.feed_per_tooth * kTrackSpeed / kTwoPi; }

// 20 mm of a track at the cut's feed, moved as `at` says.
template <class At>
CutTrack track_of(const FloorCut& f, At at) {
  CutTrack track{.step = kTrackStep, .displacement = {}, .marks = {}};
  const double feed_rate = feed_rate_of(f);
  for (std::size_t i = 0; static_cast<double>(i) * kTrackStep * feed_rate < 20e-3; ++i) {
    const double time = static_cast<double>(i) * kTrackStep;
    track.displacement.push_back(Eigen::Vector3d(at(time)).template cast<float>());
    if (i % 25 == 0)
      track.marks.push_back({i, feed_rate * time, kTrackSpeed * time, feed_rate, f.cut.feed_direction, 0.5e-3});
  }
  return track;
}

const auto kStill = [](double) { return Eigen::Vector3d(0, 0, 0); };

std::optional<ProfileRoughness> floor_roughness(const FloorCut& f, const CutTrack& track, double begin = 2e-3,
                                                double end = 18e-3) {
  const MilledHeights heights = [&](double from, double spacing, std::size_t count) {
    return floor_heights(f.tool, f.cut, track, from, spacing, count);
  };
  return mean_of(milled_lengths(heights, begin, end));
}

// Of the marks of an inclined ball: arcs of its radius, as far apart as the feed. Fails where the sweep's feed, speed
// or form is not the track's.
TEST(MilledProfile, OfAnInclinedBallIsTheArcsOfItsFeed) {
  for (const double feed : {0.1e-3, 0.2e-3}) {
    FloorCut f;
    f.cut.lead = deg_to_rad(20.0);
    f.cut.feed_per_tooth = feed;
    const auto r = floor_roughness(f, track_of(f, kStill));
    ASSERT_TRUE(r);
    const double height = feed * feed / (8.0 * 4e-3);
    EXPECT_NEAR(r->ra, kArcRa * height, 0.03 * kArcRa * height) << feed;
    EXPECT_NEAR(r->rt, height, 0.12 * height) << feed;  // points 5 um apart hardly meet a cusp
  }
}

// A wave less curved than the ball, over marks that are much lower. Fails where the motion is not the sample's of that
// place, and where it counts in other axes than z.
TEST(MilledProfile, OfABallThatMovesUpAndDownIsTheWaves) {
  FloorCut f;
  f.cut.lead = deg_to_rad(20.0);
  f.cut.feed_per_tooth = 0.02e-3;
  const double wave_hz = feed_rate_of(f) / 0.4e-3;  // two waves a sampling length
  const auto up = [&](double t) { return Eigen::Vector3d(0, 0, 2e-7 * std::sin(kTwoPi * wave_hz * t) - 50e-6); };
  EXPECT_NEAR(floor_roughness(f, track_of(f, up)).value().ra, 2.0 / std::numbers::pi * 2e-7, 0.1 * 2e-7);
}

// The sweep itself, of a whole surface: fails where the line, phase or run-in of the track's own pass is off.
TEST(MilledProfile, OfABallIsThatOfItsSurface) {
  FloorCut f;
  f.cut.lead = deg_to_rad(10.0);
  f.tool.runout = 1e-6;
  const auto shaken = [](double t) {
    return Eigen::Vector3d(3e-6 * std::sin(kTwoPi * 757 * t), 2e-6 * std::cos(kTwoPi * 757 * t),
                           1e-6 * std::sin(kTwoPi * 130 * t));
  };
  const CutTrack track = track_of(f, shaken);
  const double from = 10e-3, spacing = 5e-6;
  const std::vector<double> floor = floor_heights(f.tool, f.cut, track, from, spacing, 160);
  const CutterMotion motion = cutter_motion(f.tool, f.cut, sampled_displacement(0.0, kTrackStep, track.displacement));
  HeightMap map{.along = 160,
                .across = 41,
                .spacing_along = spacing,
                .spacing_across = spacing,
                .heights = std::vector<double>(160 * 41, kNaN)};
  const std::vector<CutterPass> pass{{.begin = -from, .length = 20e-3}};
  (void)SurfaceSweep(motion, f.cut, spacing, spacing).sweep(map, {0, 160, 0, 41}, pass);
  for (std::size_t i = 0; i < 160; ++i)
    ASSERT_NEAR(-map.at(i, 20), floor[i], 0.05e-6) << i;  // 0.1 mm beside: 20 * 5 um
}

// The floor lies as far in the part as the tool does; fails with a sign or a lost mean.
TEST(FloorHeights, AreIntoThePart) {
  FloorCut f;
  const CutTrack track = track_of(f, [](double) { return Eigen::Vector3d(30e-6, -40e-6, -50e-6); });
  for (const double height : floor_heights(f.tool, f.cut, track, 5e-3, 5e-6, 160)) EXPECT_NEAR(height, 50e-6, 3e-6);
}

// Motion is in workpiece axes: with the feed along +Y, what moves along Y moves along the feed. Aside, up the slope of
// the track, it is seen more.
TEST(FloorHeights, TurnTheMotionIntoTheFeed) {
  FloorCut f;
  f.cut.lead = deg_to_rad(20.0);
  const double once = kTrackSpeed;
  const auto ra = [&](double direction, const Eigen::Vector3d& way) {
    f.cut.feed_direction = direction;
    return floor_roughness(f, track_of(f, [&](double t) { return Eigen::Vector3d(way * std::sin(once * t)); }))->ra;
  };
  const Eigen::Vector3d x(40e-6, 0, 0), y(0, 40e-6, 0);
  EXPECT_NEAR(ra(0.0, x), ra(0.5 * std::numbers::pi, y), 1e-4 * ra(0.0, x));
  EXPECT_GT(ra(0.0, y), 1.2 * ra(0.0, x));
}

TEST(FloorHeights, AreUnknownWhereTheToolWasOutOfThePartOrStood) {
  FloorCut f;
  const auto unknown = [&](const CutTrack& track, double from) {
    return std::isnan(floor_heights(f.tool, f.cut, track, from, 5e-6, 160).at(80));
  };
  CutTrack track = track_of(f, kStill);
  EXPECT_FALSE(unknown(track, 5e-3));
  EXPECT_TRUE(unknown(track, -1e-3));
  EXPECT_TRUE(unknown(track, 19.9e-3));
  EXPECT_TRUE(unknown({}, 0.0));
  for (TrackMark& mark : track.marks)
    if (mark.along > 5.3e-3 && mark.along < 5.4e-3) mark.axial_depth = 0.0;
  EXPECT_TRUE(unknown(track, 5e-3));
  EXPECT_FALSE(unknown(track, 5.5e-3));
  for (TrackMark& mark : track.marks)
    if (mark.along > 7.3e-3 && mark.along < 7.4e-3) mark.feed_rate *= 0.2;
  EXPECT_TRUE(unknown(track, 7e-3));
  f.cut.lead = deg_to_rad(89.0);
  EXPECT_THROW(floor_heights(f.tool, f.cut, track, 10e-3, 5e-6, 160), std::invalid_argument);
}

}  // namespace
}  // namespace stillcut
