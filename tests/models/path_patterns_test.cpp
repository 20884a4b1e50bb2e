// Tool path patterns: what is true of a path in any region, and of each pattern. Regions are random, seeded.
#include "models/path_patterns.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <set>
#include <stdexcept>

#include "tests/models/machined_regions.hpp"

namespace stillcut {
namespace {

constexpr std::array kAllPatterns{PatternKind::zig,           PatternKind::zig_zag,   PatternKind::periphery_in,
                                  PatternKind::periphery_out, PatternKind::spiral_in, PatternKind::spiral_out};
constexpr double kChord = 12e-6;  // m, by which chords may leave their arc, and what is no gap
constexpr double kHeight = 2e-3, kClearance = 4e-3;

PatternSettings tool(double diameter_mm, double step_over_mm, Milling milling = Milling::down) {
  PatternSettings settings;
  settings.tool_radius = 0.5e-3 * diameter_mm;
  settings.step_over = 1e-3 * step_over_mm;
  settings.z = kHeight;
  settings.clearance = kClearance;
  settings.milling = milling;
  return settings;
}

Region square() { return {test::box_mm(0, 0, 300, 300), {}}; }
bool of_lines(PatternKind kind) { return kind == PatternKind::zig || kind == PatternKind::zig_zag; }
Eigen::Vector2d direction(const PathMove& move) { return (move.to - move.from).head<2>().normalized(); }

// Calls with every pattern of random tools and steps in random regions.
template <typename Check>
void in_random_regions(int regions, bool face, double largest_step, Check check) {
  std::mt19937 random(2017);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  for (int i = 0; i < regions; ++i) {
    const Region region = test::random_region(random, i);
    PatternSettings settings = tool(14.0 + 14.0 * share(random), 1.0, i % 3 == 0 ? Milling::up : Milling::down);
    settings.step_over = settings.tool_radius * std::lerp(0.5, largest_step, share(random));
    settings.face = face;
    const double angle = 2.0 * std::numbers::pi * share(random);
    for (const PatternKind kind : kAllPatterns) {
      SCOPED_TRACE("region " + std::to_string(i) + ", " + pattern_name(kind, angle));
      check(region, kind, angle, settings, make_pattern(region, kind, angle, settings), random);
    }
  }
}

TEST(PathPatterns, HaveTheirNames) {
  const double degree = std::numbers::pi / 180.0;
  EXPECT_EQ(pattern_name(PatternKind::zig, 45 * degree), "zig 45");
  EXPECT_EQ(pattern_name(PatternKind::zig_zag, -0.0), "zig-zag 0");
  EXPECT_EQ(pattern_name(PatternKind::zig_zag, 22.5 * degree), "zig-zag 22.5");
  EXPECT_EQ(pattern_name(PatternKind::zig, 100.0 / 3.0 * degree), "zig 33.33");
  EXPECT_EQ(pattern_name(PatternKind::periphery_in, 1.0), "periphery in");
  EXPECT_EQ(pattern_name(PatternKind::periphery_out, 1.0), "periphery out");
  EXPECT_EQ(pattern_name(PatternKind::spiral_in, 1.0), "spiral in");
  EXPECT_EQ(make_pattern(square(), PatternKind::spiral_out, 0.0, tool(25, 12.5)).name, "spiral out");
}

// The pocket of Tunc and Stoddart's case study: 275 mm for the tool's centre, 22 steps of 12.5 mm.
TEST(PathPatterns, ZigCutsThePapersPocketInTwentyThreeLines) {
  for (const double angle : {0.0, 0.5 * std::numbers::pi, std::numbers::pi}) {
    const ToolPath path = make_pattern(square(), PatternKind::zig, angle, tool(25, 12.5));
    const auto lines = std::count_if(path.moves.begin(), path.moves.end(), [](const auto& m) { return m.cutting; });
    EXPECT_EQ(lines, 23) << angle;
    EXPECT_NEAR(test::cutting_length(path), 23 * 0.275, 1e-6) << angle;
  }
  // 275 mm is no multiple of 7 mm: 40 steps of 6.875 mm.
  EXPECT_NEAR(test::cutting_length(make_pattern(square(), PatternKind::zig, 0.0, tool(25, 7))), 41 * 0.275, 1e-6);
}

TEST(PathPatterns, AFaceIsCutUpToItsEdgeAndAroundIslands) {
  PatternSettings settings = tool(25, 12.5);
  settings.face = true;
  const ToolPath path = make_pattern(square(), PatternKind::zig, 0.0, settings);
  EXPECT_NEAR(test::cutting_length(path), 25 * 0.3, 1e-6);
  const Region island{square().polygon, {test::box_mm(100, 100, 200, 200)}};
  const ToolPath loops = make_pattern(island, PatternKind::periphery_in, 0.0, settings);
  EXPECT_LT(test::distance_to_cuts(loops, {0.3, 0.3}), 1e-6);
  EXPECT_NEAR(test::distance_to_cuts(loops, {0.2, 0.15}), 12.5e-3, 1e-6);
}

TEST(PathPatterns, PeripheryVisitsAllFourDirectionsOfASquareAlike) {
  const ToolPath path = make_pattern(square(), PatternKind::periphery_in, 0.0, tool(25, 12.5));
  std::array<double, 4> length{};
  for (const PathMove& move : path.moves) {
    if (!move.cutting || move.milling == Milling::slot) continue;
    const double quarter = std::atan2(direction(move).y(), direction(move).x()) / (0.5 * std::numbers::pi);
    ASSERT_NEAR(quarter, std::round(quarter), 1e-6);
    length[(static_cast<int>(std::round(quarter)) + 4) % 4] += (move.to - move.from).norm();
  }
  // Loops of 275, 250, ... 25 mm: the middle is then within the step over.
  for (const double each : length) EXPECT_NEAR(each, 0.025 * 66, 1e-6);
}

TEST(PathPatterns, StayInTheRegionAndJoin) {
  for (const bool face : {false, true})
    in_random_regions(
        40, face, 2.0,
        [&](const Region& region, PatternKind, double, const PatternSettings& settings, const ToolPath& path,
            std::mt19937&) {
          ASSERT_FALSE(path.moves.empty());
          EXPECT_EQ(path.moves.front().from.z(), kHeight + kClearance);
          EXPECT_EQ(path.moves.back().to.z(), kHeight + kClearance);
          for (std::size_t i = 0; i < path.moves.size(); ++i) {
            const PathMove& move = path.moves[i];
            if (i > 0) {
              ASSERT_EQ(move.from, path.moves[i - 1].to) << "move " << i;
            }
            ASSERT_NE(move.from, move.to) << "move " << i;
            EXPECT_EQ(move.milling.has_value(), move.cutting);
            const bool vertical = move.from.head<2>() == move.to.head<2>();
            ASSERT_TRUE(vertical || move.from.z() == move.to.z());
            ASSERT_EQ(move.cutting, !vertical && move.from.z() == kHeight) << "move " << i;
            if (!move.cutting) continue;
            // Steps of 3 mm, and the corners of the region that a step may pass.
            const Eigen::Vector2d from = move.from.head<2>(), to = move.to.head<2>();
            const int steps = 1 + static_cast<int>((to - from).norm() / 3e-3);
            for (int k = 0; k <= steps; ++k) {
              const Eigen::Vector2d at = from + (to - from) * k / steps;
              ASSERT_TRUE(test::machined(region, at) || test::distance_to_edges(region, at) < kChord) << at.transpose();
              ASSERT_GT(test::distance_to_edges(region, at, face), settings.tool_radius - kChord) << at.transpose();
            }
            test::for_each_edge(region, [&](const Eigen::Vector2d& corner, const auto&, bool island) {
              if (island || !face) {
                ASSERT_GT(test::distance_to_line(from, to, corner), settings.tool_radius - kChord);
              }
            });
          }
        });
}

// Loops cut all that a tool in the region can reach; lines come near all places where the tool's centre may be, and
// leave cusps only at walls.
TEST(PathPatterns, CutWhatTheToolCanReach) {
  in_random_regions(24, false, 2.0,
                    [](const Region& region, PatternKind kind, double, const PatternSettings& settings,
                       const ToolPath& path, std::mt19937& random) {
                      std::uniform_real_distribution<double> share(0.0, 1.0);
                      const double radius = settings.tool_radius;
                      int tried = 0;
                      while (tried < 150) {
                        Eigen::Vector2d at = test::random_point(random, region);
                        if (!test::machined(region, at) || test::distance_to_edges(region, at) < radius + kChord)
                          continue;
                        const double turn = 2.0 * std::numbers::pi * share(random);
                        if (!of_lines(kind))
                          at += radius * share(random) * Eigen::Vector2d(std::cos(turn), std::sin(turn));
                        ASSERT_LT(test::distance_to_cuts(path, at), radius + 2.0 * kChord) << at.transpose();
                        ++tried;
                      }
                    });
}

// Periphery by steps up to the radius: no place is farther from a pass than the step over.
TEST(PathPatterns, PeripheryLeavesNoPlaceFartherThanTheStepOver) {
  in_random_regions(
      20, false, 1.0,
      [](const Region& region, PatternKind kind, double, const PatternSettings& settings, const ToolPath& path,
         std::mt19937& random) {
        if (kind != PatternKind::periphery_in && kind != PatternKind::periphery_out) return;
        for (int tried = 0; tried < 150;) {
          const Eigen::Vector2d at = test::random_point(random, region);
          if (!test::machined(region, at) || test::distance_to_edges(region, at) < settings.tool_radius + kChord)
            continue;
          ASSERT_LT(test::distance_to_cuts(path, at), settings.step_over + 2.0 * kChord) << at.transpose();
          ++tried;
        }
      });
}

TEST(PathPatterns, LinesGoAlongTheirAngleAndZigZagTakesTurns) {
  in_random_regions(24, false, 2.0,
                    [](const Region&, PatternKind kind, double angle, const PatternSettings& settings,
                       const ToolPath& path, std::mt19937&) {
                      if (!of_lines(kind)) return;
                      const Eigen::Vector2d along(std::cos(angle), std::sin(angle)), left(-along.y(), along.x());
                      const Milling other = settings.milling == Milling::down ? Milling::up : Milling::down;
                      double last_side = NAN, last_sense = NAN;
                      int turns = 0;
                      for (const PathMove& move : path.moves) {
                        if (!move.cutting) continue;
                        if (kind == PatternKind::zig_zag && move.milling == Milling::slot) continue;
                        const double sense = direction(move).dot(along), side = left.dot(move.from.head<2>());
                        ASSERT_NEAR(std::abs(sense), 1.0, 1e-12);
                        ASSERT_NEAR(direction(move).dot(left), 0.0, 1e-8);
                        if (kind == PatternKind::zig) {
                          ASSERT_GT(sense, 0.0);
                        }
                        EXPECT_EQ(move.milling, sense > 0.0 ? settings.milling : other);
                        // The next line of the same piece has the other sense; another piece begins along the angle
                        // again.
                        const bool next_line = std::abs(side - last_side) > 1e-9;
                        const bool onward = (side < last_side) == (settings.milling == Milling::down);
                        if (kind == PatternKind::zig_zag && next_line && onward && sense * last_sense > 0.0) {
                          EXPECT_GT(sense, 0.0) << "two lines backward";
                        }
                        turns += sense * last_sense < 0.0 ? 1 : 0;
                        last_side = side;
                        last_sense = sense;
                      }
                      if (kind == PatternKind::zig_zag) {
                        EXPECT_GT(turns, 2);
                      }
                    });
}

TEST(PathPatterns, ZigZagAlternatesLineByLine) {
  const ToolPath path = make_pattern(square(), PatternKind::zig_zag, 0.0, tool(25, 12.5));
  int line = 0;
  for (const PathMove& move : path.moves) {
    if (!move.cutting) continue;
    if (move.milling == Milling::slot) {
      EXPECT_NEAR((move.to - move.from).norm(), 12.5e-3, 1e-6);
      continue;
    }
    EXPECT_EQ(direction(move).x() > 0.0, line % 2 == 0);
    EXPECT_EQ(move.milling, line % 2 == 0 ? Milling::down : Milling::up);
    ++line;
  }
  EXPECT_EQ(line, 23);
  EXPECT_EQ(path.moves.size(), 23U + 22U + 2U) << "linked along the wall, the tool down all the while";
}

// To a millionth where edges are straight. About corners that stand into a region Clipper places chords as the grid has
// it, up to a hundredth of a millimetre off the arc.
TEST(PathPatterns, TurnWithTheirRegion) {
  std::mt19937 random(6);
  std::uniform_real_distribution<double> turn(0.0, 2.0 * std::numbers::pi);
  for (int i = 0; i < 9; ++i) {
    const Region region = i == 0 ? square() : test::random_region(random, i);
    const double by = turn(random), angle = i == 0 ? 0.0 : turn(random);
    for (const PatternKind kind : kAllPatterns) {
      const ToolPath path = make_pattern(region, kind, angle, tool(20, 9));
      const ToolPath turned = make_pattern(test::turned(region, by), kind, angle + by, tool(20, 9));
      const double share = of_lines(kind) || i % 4 == 0 ? 1e-6 : 1e-4;
      EXPECT_NEAR(test::cutting_length(turned), test::cutting_length(path), share * test::cutting_length(path))
          << i << ": " << path.name;
    }
  }
}

// What a pass meets on either side: points of a grid that no move before it has cut, beside it and within the radius.
struct Met {
  int left = 0, right = 0;
};

class UncutGrid {
 public:
  UncutGrid(const Region& region, double radius) : radius_(radius) {
    std::mt19937 random(1);
    for (int i = 0; i < 6'000; ++i)
      if (const Eigen::Vector2d at = test::random_point(random, region); test::machined(region, at))
        points_.push_back(at);
  }

  Met cut(const PathMove& move) {
    const Eigen::Vector2d from = move.from.head<2>(), to = move.to.head<2>(), along = direction(move);
    Met met;
    std::erase_if(points_, [&](const Eigen::Vector2d& point) {
      if (test::distance_to_line(from, to, point) > radius_) return false;
      const Eigen::Vector2d offset = point - from;
      const double beside = along.x() * offset.y() - along.y() * offset.x();
      if (offset.dot(along) > 0.0 && offset.dot(along) < (to - from).norm()) ++(beside > 0.0 ? met.left : met.right);
      return true;
    });
    return met;
  }

 private:
  double radius_;
  std::vector<Eigen::Vector2d> points_;
};

// A pattern's passes after the first; a link cuts to both sides and is none.
Met met_after_first_pass(const Region& region, const ToolPath& path, double radius) {
  UncutGrid grid(region, radius);
  Met sum;
  std::optional<Eigen::Vector2d> start;
  bool first = true, left_start = false;
  for (const PathMove& move : path.moves) {
    if (!move.cutting) {
      first = first && !left_start;
      continue;
    }
    const Met met = grid.cut(move);
    if (move.milling == Milling::slot) {
      first = false;
      continue;
    }
    if (!start) start = move.from.head<2>();
    left_start = true;
    const bool up = move.milling == Milling::up;
    if (!first) sum = {sum.left + (up ? met.right : met.left), sum.right + (up ? met.left : met.right)};
    if ((move.to.head<2>() - *start).norm() < 1e-9) first = false;  // round the first loop
  }
  return sum;
}

TEST(PathPatterns, HaveTheMaterialOnTheSideOfTheirMilling) {
  const Region plate{test::box_mm(0, 0, 200, 130), {}};
  const Region with_island{test::box_mm(0, 0, 220, 200), {test::box_mm(90, 80, 130, 110)}};
  for (const Milling milling : {Milling::down, Milling::up})
    for (const double angle : {0.7, 3.5}) {
      const PatternSettings settings = tool(20, 9, milling);
      for (const PatternKind kind : kAllPatterns) {
        SCOPED_TRACE(pattern_name(kind, angle) + (milling == Milling::up ? " up" : " down"));
        const Region turned = test::turned(plate, angle);
        const Met met = met_after_first_pass(turned, make_pattern(turned, kind, angle, settings), 10e-3);
        EXPECT_GT(met.right, 1200);
        // Outward, and in a spiral, a corner of the loop is new on both sides.
        const bool corners = kind != PatternKind::periphery_in && !of_lines(kind);
        EXPECT_LE(met.left, corners ? met.right / 10 : 0);

        const Region island = test::turned(with_island, angle);
        const Met about = met_after_first_pass(island, make_pattern(island, kind, angle, settings), 10e-3);
        EXPECT_GT(about.right, 1200);
        EXPECT_LE(about.left, about.right / 5) << about.left << " against " << about.right;
      }
    }
}

TEST(PathPatterns, GoAroundWhatSplitsTheRegion) {
  // Two rooms, and a passage too narrow for the tool.
  const Region rooms{{{0, 0},
                      {0.1, 0},
                      {0.1, 0.045},
                      {0.12, 0.045},
                      {0.12, 0},
                      {0.2, 0},
                      {0.2, 0.1},
                      {0.12, 0.1},
                      {0.12, 0.055},
                      {0.1, 0.055},
                      {0.1, 0.1},
                      {0, 0.1}},
                     {}};
  for (const PatternKind kind : kAllPatterns) {
    const ToolPath path = make_pattern(rooms, kind, 0.3, tool(20, 8));
    int changes = 0;
    bool last_right = path.moves.front().from.x() > 0.11;
    for (const PathMove& move : path.moves) {
      const bool right = move.to.x() > 0.11;
      EXPECT_FALSE(move.cutting && right != last_right) << path.name;
      changes += right != last_right ? 1 : 0;
      last_right = right;
    }
    EXPECT_EQ(changes, 1) << path.name << ": a room is finished before the next";
  }
}

TEST(PathPatterns, ASpiralIsOnePass) {
  for (const PatternKind kind : {PatternKind::spiral_in, PatternKind::spiral_out}) {
    const ToolPath path = make_pattern(square(), kind, 0.0, tool(25, 10));
    EXPECT_EQ(std::count_if(path.moves.begin(), path.moves.end(), [](const auto& m) { return !m.cutting; }), 2);
    for (const PathMove& move : path.moves) EXPECT_NE(move.milling, Milling::slot);
    // The wall is cut all along: 4 x 275 mm of moves on it.
    double at_wall = 0.0;
    for (const PathMove& move : path.moves) {
      const auto on = [](const Eigen::Vector3d& p) {
        return std::abs((p.head<2>() - Eigen::Vector2d(0.15, 0.15)).cwiseAbs().maxCoeff() - 0.1375) < 1e-6;
      };
      if (move.cutting && on(move.from) && on(move.to)) at_wall += (move.to - move.from).norm();
    }
    EXPECT_NEAR(at_wall, 4 * 0.275, 1e-3);
  }
}

TEST(PathPatterns, InBeginsAtTheWallAndOutEndsThere) {
  const auto from_middle = [](const PathMove& move) {
    return (move.to.head<2>() - Eigen::Vector2d(0.15, 0.15)).cwiseAbs().maxCoeff();
  };
  for (const auto& [in, out] : {std::pair{PatternKind::periphery_in, PatternKind::periphery_out},
                                std::pair{PatternKind::spiral_in, PatternKind::spiral_out}}) {
    const ToolPath inward = make_pattern(square(), in, 0.0, tool(25, 10));
    const ToolPath outward = make_pattern(square(), out, 0.0, tool(25, 10));
    EXPECT_NEAR(from_middle(inward.moves.front()), 0.1375, 1e-6);
    EXPECT_LT(from_middle(inward.moves.back()), 10e-3);
    EXPECT_LT(from_middle(outward.moves.front()), 10e-3);
    EXPECT_NEAR(from_middle(outward.moves.back()), 0.1375, 1e-6);
  }
}

std::string refusal(const Region& region, const PatternSettings& settings) {
  try {
    make_pattern(region, PatternKind::zig, 0.0, settings);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(PathPatterns, RefuseWhatCannotBeMachined) {
  using ::testing::StartsWith, ::testing::HasSubstr;
  const Region slot{test::box_mm(0, 0, 300, 24), {}};
  EXPECT_THAT(refusal(slot, tool(25, 5)), StartsWith("the tool, 25 mm across, does not fit into the region, whose "
                                                     "widest place takes 2"));
  EXPECT_THAT(refusal(slot, tool(25, 5)), HasSubstr("; take a smaller tool"));
  EXPECT_THAT(refusal({slot.polygon, {test::box_mm(-5, 5, 10, 10)}}, tool(5, 2)),
              HasSubstr("island 1 meets the polygon"));
  EXPECT_THAT(refusal(square(), tool(0, 5)), HasSubstr("cuts nothing"));
  EXPECT_THAT(refusal(square(), tool(25, 25.001)), HasSubstr("up to the tool's diameter, 25 mm"));
  EXPECT_THAT(refusal(square(), tool(25, 0)), HasSubstr("a step over of 0 mm is out of range"));
  EXPECT_THAT(refusal(square(), tool(25, 0.001)), HasSubstr("more than 10000 passes"));
  EXPECT_THAT(refusal(square(), tool(25, 5, Milling::slot)), HasSubstr("down or up"));
}

}  // namespace
}  // namespace stillcut
