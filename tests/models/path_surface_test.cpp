// The envelope of a path against the ball put down densely along it; what a path does besides cutting.
#include "models/path_surface.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "models/surface_form.hpp"
#include "tests/models/path_cuts.hpp"

namespace stillcut::test {
namespace {

// Fails where a stroke is dropped, its closed form is wrong at an end or a slope, or the axis does not turn with it.
TEST(PathEnvelope, IsTheBallPutDownAllAlong) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> part(-1.0, 1.0);
  for (int n = 0; n < 5; ++n) {
    std::vector<Eigen::Vector3d> tips, axes;
    for (int i = 0; i < 7; ++i) {
      tips.emplace_back(1e-3 * part(random), 1e-3 * part(random), 0.5e-3 * part(random));
      axes.emplace_back(Eigen::Vector3d(0.5 * part(random), 0.5 * part(random), 1.0).normalized());
    }
    tips[4] = tips[3] + 0.3e-3 * Eigen::Vector3d::UnitZ();  // straight up
    axes[4] = axes[3];
    ToolPath path;
    add_row(path, tips, axes);
    const CutterPath cutter = cutter_path(ball(2e-3), path);
    const HeightMap grid = uncut_map(2e-3, 2e-3, 0.1e-3);
    const auto laid = PathEnvelope(cutter, {-1e-3, -1e-3}).over(grid, {3, 17, 0, grid.across});
    for (std::size_t k = 0; k < laid.size(); ++k) {
      const Eigen::Vector2d at(-1e-3 + 0.1e-3 * static_cast<double>(3 + k % 14),
                               -1e-3 + 0.1e-3 * static_cast<double>(k / 14));
      double lowest = 1.0, kappa = 0.0;
      for (const PathPiece& piece : cutter.pieces)
        for (int i = 0; i <= 1000; ++i) {
          const BallPose pose = ball_pose(cutter, piece, piece.duration * i / 1000.0);
          const double below = 1e-6 - (at - pose.centre.head<2>()).squaredNorm();
          if (!(below > 0.0 && pose.centre.z() - std::sqrt(below) < lowest)) continue;
          lowest = pose.centre.z() - std::sqrt(below);
          const Eigen::Vector3d out = Eigen::Vector3d(at.x(), at.y(), lowest) - pose.centre;
          kappa = std::acos(-out.normalized().dot(pose.orientation.col(2)));
        }
      if (lowest == 1.0) {
        EXPECT_TRUE(std::isnan(laid[k].height));
        continue;
      }
      EXPECT_LE(laid[k].height, lowest + 2e-9);
      if (std::abs(laid[k].height - lowest) < 1e-8) {
        EXPECT_NEAR(laid[k].kappa, kappa, 0.02);
        continue;
      }
      EXPECT_GT(laid[k].height, lowest - 2e-6) << k;  // near the rim a ball 1 um beside is lower by more
    }
  }
}

// What is left of a cut is the teeth's: lower by no more than chords, and higher by marks alone.
TEST(PathSurface, WithoutTheEnvelopeMarksAreLeft) {
  ToolPath path;
  const Eigen::Vector3d axis(std::sin(0.2), 0.0, std::cos(0.2));
  for (double y = -0.4e-3; y < 0.8e-3; y += 0.2e-3)
    add_row(path, {{-2e-3, y, -0.12e-3}, {1.5e-3, y, 0.3e-3}}, {axis, axis});
  PathSurface surface =
      path_surface(cutter_path(ball(), path), {0, 0, 0.4e-3, 0.3e-3}, {.spacing = 4e-6, .keep_envelope = true});
  EXPECT_EQ(surface.uncovered + surface.on_shank, 0U);
  remove_envelope(surface.map, surface.envelope);
  double highest = 0.0;
  for (const double height : surface.map.heights) {
    EXPECT_GT(height, -1e-12);
    highest = std::max(highest, height);
  }
  const double mark = 0.02e-3 * 0.02e-3 / (8 * 4e-3);
  EXPECT_NEAR(highest, mark, 0.2 * mark);  // along the slope the marks are a little longer
  HeightMap map = surface.map;
  EXPECT_THROW(remove_envelope(map, uncut_map(1e-3, 1e-3, 0.5e-3)), std::invalid_argument);
}

TEST(PathSurface, CountsWhatItDoesNotKnow) {
  // The path ends within the window, R and half a window before its end.
  const CutterPath path = cutter_path(ball(1e-3), straight_path({{-2e-3, 0, 0}, {0, 0, 0}}));
  const PathSurface surface = path_surface(path, {0.3e-3, -0.05e-3, 0.4e-3, 0.1e-3}, {.spacing = 4e-6});
  std::size_t unknown = 0;
  for (const double height : surface.map.heights) unknown += std::isnan(height);
  EXPECT_EQ(surface.uncovered, unknown);
  EXPECT_NEAR(static_cast<double>(unknown) / static_cast<double>(surface.map.heights.size()), 0.5, 0.04);
  EXPECT_EQ(surface.on_shank, 0U);
  EXPECT_EQ(surface.origin, Eigen::Vector2d(0.3e-3, -0.05e-3));
}

// The tool leans 60 degrees off the feed: the ball is a ball only on the lower side of that.
TEST(PathSurface, WhatTheShankMakesIsNotKnown) {
  const Eigen::Vector3d axis(0.0, std::sin(deg_to_rad(60)), std::cos(deg_to_rad(60)));
  ToolPath path;
  add_row(path, {{-1e-3, 0, 0}, {1e-3, 0, 0}}, {axis, axis});
  const CutterPath cutter = cutter_path(ball(1e-3), path);
  const double centre = 0.5e-3 * axis.y(), limit = 0.5e-3 * std::sin(deg_to_rad(30));  // beside which kappa is 90
  const PathSurface beside = path_surface(cutter, {0, centre + limit - 0.05e-3, 0.1e-3, 0.1e-3}, {.spacing = 4e-6});
  EXPECT_NEAR(static_cast<double>(beside.on_shank) / static_cast<double>(beside.map.heights.size()), 0.5, 0.02);
  EXPECT_EQ(beside.shank_line, 1);
  EXPECT_EQ(beside.uncovered, 0U);
  try {
    (void)path_surface(cutter, {0, centre + limit + 0.01e-3, 0.1e-3, 0.1e-3}, {.spacing = 4e-6});
    ADD_FAILURE();
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("line 1: the tool leans"));
  }
}

// A rapid cuts nothing, but where it passes below the surface it is told of.
TEST(PathSurface, TellsOfRapidsBelowTheSurface) {
  ToolPath path;
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  for (double y = -0.4e-3; y < 0.8e-3; y += 0.2e-3) add_row(path, {{-1e-3, y, 0}, {1e-3, y, 0}}, {up, up});
  const PathWindow window{0, 0, 0.2e-3, 0.2e-3};
  const PathSurface sound = path_surface(cutter_path(ball(), path), window, {.spacing = 4e-6});
  EXPECT_EQ(sound.struck, 0U);
  for (const double depth : {-0.1e-3, 0.1e-3}) {
    PathMove rapid{.from = path.moves.back().to, .to = {0.1e-3, 0.1e-3, -depth}, .cutting = false};
    rapid.line = 99;
    ToolPath with = path;
    with.moves.push_back(rapid);
    const PathSurface surface = path_surface(cutter_path(ball(), with), window, {.spacing = 4e-6});
    EXPECT_EQ(surface.map.heights, sound.map.heights);
    EXPECT_EQ(surface.struck > 0, depth > 0.0);
    if (depth < 0.0) continue;
    EXPECT_NEAR(surface.deepest_strike, depth, 0.02 * depth);
    EXPECT_EQ(surface.strike_line, 99);
  }
}

TEST(PathSurface, TheMiddleIsThatOfTheCuttingMoves) {
  ToolPath path = straight_path({{0, 0, 0}, {4e-3, 0, 0}, {4e-3, 2e-3, 0}});
  path.moves.push_back({.from = path.moves.back().to, .to = {90e-3, 90e-3, 9e-3}, .cutting = false});
  const PathWindow window = middle_of(cutter_path(ball(), path), 1e-3, 0.5e-3);
  EXPECT_NEAR(window.x, 1.5e-3, 1e-12);
  EXPECT_NEAR(window.y, 0.75e-3, 1e-12);
  EXPECT_EQ(window.along, 1e-3);
  EXPECT_EQ(window.across, 0.5e-3);
}

}  // namespace
}  // namespace stillcut::test
