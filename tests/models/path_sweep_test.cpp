// Surfaces of tool paths against parallel passes, against closed forms on cylinders and spheres, and what is true of
// any.
#include "models/path_sweep.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <numeric>
#include <random>

#include "tests/models/path_cuts.hpp"

namespace stillcut::test {
namespace {

// To within what chords of other lengths make: s^2 / 8R in two directions. One tooth cuts 18 um deeper than the ball,
// and its edge trails by a good part of the window that it is looked for in: what is cut must not be given up too
// early.
TEST(PathSweep, AFlatPathLeavesWhatParallelPassesDo) {
  for (const bool spoilt : {false, true}) {
    SweptCut c;
    c.cut.path = PathKind::zigzag;
    c.cut.lead = deg_to_rad(15);
    c.cut.tilt = deg_to_rad(-5);
    c.tool.helix = deg_to_rad(30);
    c.along = c.across = 0.5e-3;
    if (spoilt) {
      c.cut.lead = deg_to_rad(40);
      c.tool.helix = deg_to_rad(50);
      c.tool.runout = 20e-6, c.tool.axial_runout = -5e-6;
      c.displacement.reach = {0, 0, 3e-6};
      c.displacement.speed = 3e-6 * kTwoPi * 310.0;
      c.displacement.at = [](double t) -> Eigen::Vector3d { return {0, 0, 3e-6 * std::sin(kTwoPi * 310.0 * t)}; };
    }
    const CutterMotion motion = cutter_motion(c.tool, c.cut, c.displacement);
    const HeightMap flat = swept(c),
                    path = swept(path_of(c, motion, passes_of(c, motion)), {0, 0, c.along, c.across}, c.spacing);
    for (std::size_t i = 0; i < flat.heights.size(); ++i)
      ASSERT_NEAR(path.heights[i], flat.heights[i], 2.0 * c.spacing * c.spacing / (8.0 * 4e-3)) << i;
  }
}

// A ball's rows a_e apart on a surface that is curved across them. Deviations are along the normal, over one row; for
// arcs their mean is 4/(9 sqrt 3) of their height. Fails where a centre is misplaced, or edges that lie deeper are
// lost.

constexpr double kRow = 0.4e-3, kForm = 20e-3, kLead = 0.25;

// Places and normals of rows, `along` and `across` in m of arc.
using Form = std::function<std::pair<Eigen::Vector3d, Eigen::Vector3d>(double along, double across)>;

ToolPath rows_on(const Form& form, int rows, double half_length, double chord) {
  ToolPath path;
  for (int row = -rows; row <= rows; ++row) {
    std::vector<Eigen::Vector3d> tips, axes;
    const int chords = static_cast<int>(std::ceil(2.0 * half_length / chord));
    for (int i = 0; i <= chords; ++i) {
      const double along = half_length * (2.0 * i / chords - 1.0);
      const auto [at, normal] = form(along, (row + 0.5) * kRow);
      const Eigen::Vector3d feed = (form(along + 1e-6, (row + 0.5) * kRow).first - at).normalized();
      axes.push_back((std::cos(kLead) * normal + std::sin(kLead) * feed).normalized());
      tips.push_back(at + 4e-3 * (normal - axes.back()));  // the ball touches, inclined along the feed
    }
    add_row(path, tips, axes);
  }
  return path;
}

void expect_scallops(const char* name, const Form& form, double bend, const std::function<double(Eigen::Vector3d)>& off,
                     double chord) {
  const CutterPath path = cutter_path(ball(), rows_on(form, 3, 0.6e-3, chord));
  // The valley between two rows, from one to the next along y; enough marks along x.
  const PathWindow window{-0.04e-3, -0.28e-3, 0.08e-3, 0.56e-3};
  const HeightMap map = swept(path, window, 2e-6);
  const double height = kRow * kRow / 8.0 * (1.0 / 4e-3 + bend);
  double mean_deviation = 0.0, deepest = 1.0, highest = -1.0;
  for (std::size_t i = 0; i < map.along; ++i) {
    std::vector<double> row;
    for (std::size_t j = 0; j < map.across; ++j) {
      const double y = window.y + static_cast<double>(j) * map.spacing_across;
      if (std::abs(y) > 0.5 * kRow) continue;
      ASSERT_FALSE(std::isnan(map.at(i, j))) << name;
      row.push_back(off({window.x + static_cast<double>(i) * map.spacing_along, y, map.at(i, j)}));
    }
    const double mean = std::accumulate(row.begin(), row.end(), 0.0) / static_cast<double>(row.size());
    for (const double height_there : row) {
      mean_deviation += std::abs(height_there - mean) / static_cast<double>(row.size() * map.along);
      deepest = std::min(deepest, height_there), highest = std::max(highest, height_there);
    }
  }
  EXPECT_NEAR(mean_deviation, 4.0 / (9.0 * std::sqrt(3.0)) * height, 0.01 * 4.0 / (9.0 * std::sqrt(3.0)) * height)
      << name;
  EXPECT_NEAR(highest - deepest, height, 0.03 * height) << name;  // marks and the chords along the row are in it
  EXPECT_NEAR(deepest, 0.0, 0.03 * height) << name;
}

TEST(PathSweep, ScallopsOnCurvedSurfacesAreTheClosedForms) {
  using std::sin, std::cos, Eigen::Vector3d;
  for (const double side : {1.0, -1.0}) {  // convex, concave
    const auto cylinder_off = [side](double across, double z) {
      return side * (std::hypot(across, z + side * kForm) - kForm);
    };
    // Rows along the cylinder's axis, each beside the last round it.
    expect_scallops(
        side > 0 ? "convex, along" : "concave, along",
        [side](double along, double across) -> std::pair<Vector3d, Vector3d> {
          const double turn = across / kForm;
          return {{along, kForm * sin(turn), side * kForm * (cos(turn) - 1.0)}, {0.0, side * sin(turn), cos(turn)}};
        },
        side / kForm, [&](const Vector3d& at) { return cylinder_off(at.y(), at.z()); }, 1e-3);
    // Rows round the axis, each beside the last along it: the bend across the rows is none.
    expect_scallops(
        side > 0 ? "convex, round" : "concave, round",
        [side](double along, double across) -> std::pair<Vector3d, Vector3d> {
          const double turn = along / kForm;
          return {{kForm * sin(turn), across, side * kForm * (cos(turn) - 1.0)}, {side * sin(turn), 0.0, cos(turn)}};
        },
        0.0, [&](const Vector3d& at) { return cylinder_off(at.x(), at.z()); }, 0.02e-3);
    // Great circles of a sphere.
    expect_scallops(
        side > 0 ? "ball" : "bowl",
        [side](double along, double across) -> std::pair<Vector3d, Vector3d> {
          const double turn = along / kForm, aside = across / kForm;
          const Vector3d out(sin(turn), cos(turn) * sin(aside), cos(turn) * cos(aside));
          return {side * kForm * (side * Vector3d(out.x(), out.y(), 0.0) + Vector3d(0, 0, out.z() - 1.0)),
                  {side * out.x(), side * out.y(), out.z()}};
        },
        side / kForm,
        [side](const Vector3d& at) { return side * ((at + side * kForm * Vector3d::UnitZ()).norm() - kForm); },
        0.02e-3);
  }
}

struct RandomPath {
  CutterPath path;
  PathWindow window;
  double spacing = 5e-6;
};

// Rows and kinks over hills of up to 45 degrees, the tool leaning anywhere, with what spoils a surface.
RandomPath random_path(std::mt19937& random) {
  const auto between = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  Tool tool = ball(between(1e-3, 3e-3));
  tool.teeth = 1 + static_cast<int>(random() % 3);
  tool.pitch.assign(static_cast<std::size_t>(tool.teeth), kTwoPi / tool.teeth);
  tool.helix = deg_to_rad(between(0, 45));
  tool.runout = random() % 2 == 0 ? 0.0 : between(0.0, 10e-6);
  tool.axial_runout = random() % 2 == 0 ? 0.0 : between(-3e-6, 3e-6);
  tool.runout_angle = between(0, kTwoPi);
  Displacement displacement;
  if (random() % 2 == 0) {
    const double amplitude = between(0, 4e-6), turn = kTwoPi * between(50, 300);
    displacement.reach = Eigen::Vector3d::Constant(amplitude);
    displacement.speed = std::sqrt(3.0) * amplitude * turn;
    displacement.at = [=](double t) -> Eigen::Vector3d {
      return amplitude * Eigen::Vector3d(std::sin(turn * t), std::cos(turn * t), std::sin(turn * t));
    };
  }
  ToolPath path;
  const double hill = between(-0.3e-3, 0.3e-3), wave = between(1e3, 3e3), lean = between(0, 0.5),
               way = between(0, kTwoPi);
  for (double y = -0.1e-3; y < 0.25e-3; y += between(0.04e-3, 0.1e-3)) {
    std::vector<Eigen::Vector3d> tips, axes;
    for (double x = -0.3e-3; x < 0.5e-3; x += between(0.003e-3, 0.2e-3)) {
      tips.emplace_back(x, y + between(-5e-6, 5e-6), hill * std::sin(wave * (x + y)));
      const double there = lean + between(-0.02, 0.02);
      axes.emplace_back(std::sin(there) * std::cos(way), std::sin(there) * std::sin(way), std::cos(there));
    }
    if (random() % 2 == 0) std::reverse(tips.begin(), tips.end());
    add_row(path, tips, axes);
  }
  for (PathMove& move : path.moves)
    if (move.cutting) move.feed_rate = between(0.03e-3, 0.06e-3) * tool.teeth * 100.0;
  return {cutter_path(tool, path, {}, displacement), {0.0, 0.0, 0.12e-3, 0.1e-3}};
}

// No point of an edge, placed by the formula at a random time, lies below the surface by more than grid, chords and the
// corners of the path explain. Fails where a stretch, a window or a piece of a sheet is left out.
TEST(PathSweep, NoEdgeIsEverBelowTheSurface) {
  std::mt19937 random(20261126);
  int near = 0, looked_at = 0;
  for (int n = 0; n < 20; ++n) {
    const auto [path, window, spacing] = random_path(random);
    const HeightMap map = swept(path, window, spacing);
    const double radius = 0.5 * path.tool.diameter;
    std::uniform_real_distribution<double> part(0.0, 1.0);
    for (int k = 0; k < 60000; ++k) {
      const PathPiece& piece = path.pieces[random() % path.pieces.size()];
      if (!piece.feeds) continue;
      const double elapsed = part(random) * piece.duration;
      // Towards the place of the ball that faces down, or thereabouts: few others are ever near the surface.
      const BallPose pose = ball_pose(path, piece, elapsed);
      const double kappa = std::clamp(std::acos(pose.orientation(2, 2)) + 0.8 * (part(random) - 0.5), 0.0, 1.5);
      const EdgePoint point = ball_edge_point(path.tool, kappa);
      if (point.radius < 3.0 * spacing + 2.0 * (path.fastest_radian + path.displacement.speed / piece.spindle_speed))
        continue;  // where the edge stands still for a moment, its sheet folds
      const Eigen::Vector3d at = edge_position(path, piece, random() % path.tooth_angle.size(), point, elapsed);
      const double x = (at.x() - window.x) / map.spacing_along, y = (at.y() - window.y) / map.spacing_across;
      if (x < 0 || y < 0 || x >= static_cast<double>(map.along - 1) || y >= static_cast<double>(map.across - 1))
        continue;
      const auto i = static_cast<std::size_t>(x), j = static_cast<std::size_t>(y);
      const double u = x - std::floor(x), v = y - std::floor(y);
      const double surface = (1 - v) * ((1 - u) * map.at(i, j) + u * map.at(i + 1, j)) +
                             v * ((1 - u) * map.at(i, j + 1) + u * map.at(i + 1, j + 1));
      const double upright = (pose.centre.z() - at.z()) / radius;
      if (!(upright > 0.5)) continue;
      const double in_a_step = spacing * path.fastest_radian / point.radius;
      EXPECT_GT(at.z(), surface - spacing * spacing / (radius * std::pow(upright, 3)) - 2.0 * in_a_step) << n;
      ++looked_at;
      near += at.z() < surface + 0.2e-6;
    }
  }
  EXPECT_GT(looked_at, 5000);
  EXPECT_GT(near, 100);
}

TEST(PathSweep, TilesDoNotShowInTheHeights) {
  std::mt19937 random(7);
  for (int n = 0; n < 8; ++n) {
    const auto [path, window, spacing] = random_path(random);
    const HeightMap whole = swept(path, window, spacing);
    HeightMap tiled = uncut_map(window.along, window.across, spacing);
    const PathSweep sweep(path, tiled, {window.x, window.y}, true);
    auto tiles = map_tiles(tiled, 9);
    std::shuffle(tiles.begin(), tiles.end(), random);
    for (const MapTile& tile : tiles) sweep.sweep(tiled, tile);
    EXPECT_EQ(std::memcmp(whole.heights.data(), tiled.heights.data(), whole.heights.size() * sizeof(double)), 0) << n;
  }
}

TEST(PathSweep, RefusesGridsThatAreTooCoarseAndPathsElsewhere) {
  const CutterPath path = cutter_path(ball(), straight_path({{0, 0, 0}, {1e-3, 0, 0}}));
  const auto refusal = [&](double spacing, const Eigen::Vector2d& origin, bool allow_coarse) -> std::string {
    try {
      const PathSweep sweep(path, uncut_map(0.1e-3, 0.1e-3, spacing), origin, allow_coarse);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(refusal(4e-6, {0, 0}, false), "");
  EXPECT_THAT(refusal(5e-6, {0, 0}, false), testing::HasSubstr("at most 0.004 mm"));
  EXPECT_EQ(refusal(5e-6, {0, 0}, true), "");
  EXPECT_THAT(refusal(4e-6, {0, 10e-3}, false), testing::HasSubstr("does not come"));
}

}  // namespace
}  // namespace stillcut::test
