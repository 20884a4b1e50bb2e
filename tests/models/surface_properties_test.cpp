// What is true of any swept surface. Cuts are random, seeded: shape, runout, inclination, path, vibration.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <random>

#include "models/surface_refinement.hpp"
#include "tests/models/swept_cuts.hpp"

namespace stillcut::test {
namespace {

SweptCut random_cut(std::mt19937& random) {
  const auto between = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  SweptCut c;
  c.tool.shape = random() % 4 == 0 ? ToolShape::end : ToolShape::ball;
  c.tool.teeth = 1 + static_cast<int>(random() % 4);
  const double uneven = c.tool.teeth > 1 ? between(0.0, 0.3) : 0.0;
  c.tool.pitch.assign(static_cast<std::size_t>(c.tool.teeth), kTwoPi / c.tool.teeth);
  c.tool.pitch.front() += uneven, c.tool.pitch.back() -= uneven;
  c.tool.diameter = between(1e-3, 3e-3);
  c.tool.helix = deg_to_rad(between(0, 45));
  c.tool.runout = random() % 2 == 0 ? 0.0 : between(0.0, 5e-6);
  c.tool.axial_runout = random() % 2 == 0 ? 0.0 : between(-2e-6, 2e-6);
  c.tool.runout_angle = between(0, kTwoPi);
  c.cut.feed_per_tooth = between(0.03e-3, 0.06e-3);
  c.cut.step_over = between(0.05e-3, 0.15e-3);
  c.cut.lead = deg_to_rad(between(-20, 20));
  c.cut.tilt = deg_to_rad(between(-20, 20));
  c.cut.redundancy = between(-3, 3);
  c.cut.feed_direction = between(-3, 3);
  c.cut.path = random() % 2 == 0 ? PathKind::zigzag : PathKind::unidirectional;
  c.spacing = 5e-6;
  c.along = 0.15e-3;
  c.across = 0.12e-3;
  if (random() % 2 == 0) {
    const double frequency = between(50, 300), amplitude = between(0, 4e-6);
    std::vector<Eigen::Vector3f> samples;
    for (int i = 0; i < 20000; ++i) {
      const double turn = kTwoPi * frequency * 2e-5 * i;
      samples.emplace_back(
          Eigen::Vector3d(amplitude * std::sin(turn), amplitude * std::cos(turn), 0.5 * amplitude * std::sin(turn))
              .cast<float>());
    }
    c.displacement = sampled_displacement(0.0, 2e-5, std::move(samples));
  }
  return c;
}

// No point of an edge, placed by the formula at a random time, lies below the surface; on the tracks, every grid point
// has been cut. Fails where a window, a pass or a turn is left out, or where a patch is lost.
TEST(SurfaceProperties, NoEdgeIsEverBelowTheSurface) {
  std::mt19937 random(20261126);
  int below_before = 0, looked_at = 0;
  for (int n = 0; n < 25; ++n) {
    const SweptCut c = random_cut(random);
    const CutterMotion motion = cutter_motion(c.tool, c.cut, c.displacement);
    const HeightMap map = swept(c);
    for (const double height : map.heights) ASSERT_FALSE(std::isnan(height)) << n;
    const auto passes = passes_of(c, motion);
    const double radius = 0.5 * c.tool.diameter, lean = motion.inclination();
    std::uniform_real_distribution<double> part(0.0, 1.0);
    for (int k = 0; k < 40000; ++k) {
      const CutterPass& pass = passes[random() % passes.size()];
      const double time = part(random) * pass.length / motion.feed_rate;
      const EdgePoint point = c.tool.shape == ToolShape::ball
                                  ? ball_edge_point(c.tool, std::abs(lean + 0.2 * (part(random) - 0.5)))
                                  : bottom_edge_point(c.tool, radius - 2.0 * c.spacing - 0.1 * radius * part(random));
      // A tooth's sheet ends with its edge, and folds where the edge stands still for a moment, in steps that the grid
      // cannot show.
      if (point.radius < 3.0 * c.spacing + 2.0 * (motion.feed_rate + c.displacement.speed) / motion.spindle_speed)
        continue;
      const Eigen::Vector3d at = edge_position(motion, pass, random() % motion.tooth_angle.size(), point, time);
      const double x = at.x() / map.spacing_along, y = at.y() / map.spacing_across;
      if (x < 0 || y < 0 || x >= static_cast<double>(map.along - 1) || y >= static_cast<double>(map.across - 1))
        continue;
      const auto i = static_cast<std::size_t>(x), j = static_cast<std::size_t>(y);
      const double u = x - std::floor(x), v = y - std::floor(y);
      const double surface = (1 - v) * ((1 - u) * map.at(i, j) + u * map.at(i + 1, j)) +
                             v * ((1 - u) * map.at(i, j + 1) + u * map.at(i + 1, j + 1));
      // The ball's arc hangs below the chords of patches and grid, s^2/8R each, in two directions; a bottom ends in a
      // cell.
      const double slack =
          c.tool.shape == ToolShape::ball ? 0.8 * c.spacing * c.spacing / radius : 1.5 * c.spacing * std::tan(lean);
      EXPECT_GT(at.z(), surface - slack) << n;
      ++looked_at;
      below_before += at.z() < surface + 0.2e-6;
    }
  }
  EXPECT_GT(looked_at, 10000);
  EXPECT_GT(below_before, 100);  // edges that nearly touch were among them
}

TEST(SurfaceProperties, TilesDoNotShowInTheHeights) {
  std::mt19937 random(7);
  for (int n = 0; n < 5; ++n) {
    const SweptCut c = random_cut(random);
    const CutterMotion motion = cutter_motion(c.tool, c.cut, c.displacement);
    const HeightMap whole = swept(c);
    HeightMap tiled = uncut_map(c.along, c.across, c.spacing);
    const SurfaceSweep sweep(motion, c.cut, tiled.spacing_along, tiled.spacing_across);
    const auto passes = passes_of(c, motion);
    auto tiles = map_tiles(tiled, 11);
    std::shuffle(tiles.begin(), tiles.end(), random);
    for (const MapTile& tile : tiles) sweep.sweep(tiled, tile, passes);
    EXPECT_EQ(std::memcmp(whole.heights.data(), tiled.heights.data(), whole.heights.size() * sizeof(double)), 0) << n;
  }
}

// The ball's own envelope is the floor: without runout and vibration nothing is lower, and somewhere it is met.
TEST(SurfaceProperties, NothingIsBelowTheEnvelope) {
  std::mt19937 random(3);
  for (int n = 0; n < 20; ++n) {
    SweptCut c = random_cut(random);
    c.tool.shape = ToolShape::ball;
    c.tool.runout = c.tool.axial_runout = 0.0;
    c.displacement = {};
    const HeightMap map = swept(c);
    const double radius = 0.5 * c.tool.diameter;
    double nearest = 1.0;
    for (std::size_t j = 0; j < map.across; ++j)
      for (std::size_t i = 0; i < map.along; ++i) {
        const double y = std::remainder(static_cast<double>(j) * map.spacing_across, c.cut.step_over);
        const double over = map.at(i, j) - (radius - std::sqrt(radius * radius - y * y));
        nearest = std::min(nearest, over);
        ASSERT_GT(over, -1e-12) << n;
      }
    EXPECT_LT(nearest, 1e-8) << n;
  }
}

TEST(SurfaceRefinement, StopsWhereTheRoughnessStandsStillAndTellsItsError) {
  SweptCut c;
  c.aligned = true;
  c.cut.lead = deg_to_rad(10);
  const CutterMotion motion = cutter_motion(c.tool, c.cut);
  const auto passes = passes_of(c, motion);
  RefinementSetup setup{.along = c.along, .across = c.across, .tolerance = 0.005};
  const RefinedSurface surface = refined_surface(motion, c.cut, passes, setup);
  EXPECT_TRUE(surface.converged);
  EXPECT_LE(surface.error, 0.005);
  setup.spacing = 2e-6;  // finer than it went
  setup.tolerance = 1.0;
  const RefinedSurface finer = refined_surface(motion, c.cut, passes, setup);
  EXPECT_GT(surface.map.spacing_along, 1.5 * finer.map.spacing_along);
  EXPECT_LE(std::abs(surface.figure / finer.figure - 1.0), surface.error + finer.error);
  setup.spacing = 0.0;
  setup.tolerance = 1e-6;
  setup.most_points = 20000;  // not to be reached: the error is told all the same
  const RefinedSurface coarse = refined_surface(motion, c.cut, passes, setup);
  EXPECT_FALSE(coarse.converged);
  EXPECT_GT(coarse.error, 1e-6);
  EXPECT_LE(coarse.map.heights.size(), 20000u);
}

TEST(SurfaceRefinement, DeviationIsFromThePlane) {
  HeightMap map = uncut_map(1e-3, 1e-3, 0.1e-3);
  EXPECT_TRUE(std::isnan(arithmetic_deviation(map)));
  for (std::size_t j = 0; j < map.across; ++j)
    for (std::size_t i = 0; i < map.along; ++i)
      map.at(i, j) = 3e-6 + 1e-7 * static_cast<double>(i) - 2e-7 * static_cast<double>(j);
  EXPECT_NEAR(arithmetic_deviation(map), 0.0, 1e-15);
}

}  // namespace
}  // namespace stillcut::test
