// What is true of a tool path pattern in any region. Regions are random, seeded.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <optional>
#include <random>

#include "tests/models/pattern_cases.hpp"

namespace stillcut::test {
namespace {

TEST(PathProperties, StayInTheRegionAndJoin) {
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
              ASSERT_TRUE(machined(region, at) || distance_to_edges(region, at) < kChord) << at.transpose();
              ASSERT_GT(distance_to_edges(region, at, face), settings.tool_radius - kChord) << at.transpose();
            }
            for_each_edge(region, [&](const Eigen::Vector2d& corner, const auto&, bool island) {
              if (island || !face) {
                ASSERT_GT(distance_to_line(from, to, corner), settings.tool_radius - kChord);
              }
            });
          }
        });
}

// Loops cut all that a tool in the region can reach; lines come near all places where the tool's centre may be, and
// leave cusps only at walls.
TEST(PathProperties, CutWhatTheToolCanReach) {
  in_random_regions(24, false, 2.0,
                    [](const Region& region, PatternKind kind, double, const PatternSettings& settings,
                       const ToolPath& path, std::mt19937& random) {
                      std::uniform_real_distribution<double> share(0.0, 1.0);
                      const double radius = settings.tool_radius;
                      int tried = 0;
                      while (tried < 150) {
                        Eigen::Vector2d at = random_point(random, region);
                        if (!machined(region, at) || distance_to_edges(region, at) < radius + kChord) continue;
                        const double turn = 2.0 * std::numbers::pi * share(random);
                        if (!of_lines(kind))
                          at += radius * share(random) * Eigen::Vector2d(std::cos(turn), std::sin(turn));
                        ASSERT_LT(distance_to_cuts(path, at), radius + 2.0 * kChord) << at.transpose();
                        ++tried;
                      }
                    });
}

// Periphery by steps up to the radius: no place is farther from a pass than the step over.
TEST(PathProperties, PeripheryLeavesNoPlaceFartherThanTheStepOver) {
  in_random_regions(20, false, 1.0,
                    [](const Region& region, PatternKind kind, double, const PatternSettings& settings,
                       const ToolPath& path, std::mt19937& random) {
                      if (kind != PatternKind::periphery_in && kind != PatternKind::periphery_out) return;
                      for (int tried = 0; tried < 150;) {
                        const Eigen::Vector2d at = random_point(random, region);
                        if (!machined(region, at) || distance_to_edges(region, at) < settings.tool_radius + kChord)
                          continue;
                        ASSERT_LT(distance_to_cuts(path, at), settings.step_over + 2.0 * kChord) << at.transpose();
                        ++tried;
                      }
                    });
}

TEST(PathProperties, LinesGoAlongTheirAngleAndZigZagTakesTurns) {
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

// To a millionth where edges are straight. About corners that stand into a region Clipper places chords as the grid has
// it, up to a hundredth of a millimetre off the arc.
TEST(PathProperties, TurnWithTheirRegion) {
  std::mt19937 random(6);
  std::uniform_real_distribution<double> turn(0.0, 2.0 * std::numbers::pi);
  for (int i = 0; i < 9; ++i) {
    const Region region = i == 0 ? square() : random_region(random, i);
    const double by = turn(random), angle = i == 0 ? 0.0 : turn(random);
    for (const PatternKind kind : kAllPatterns) {
      const ToolPath path = make_pattern(region, kind, angle, tool(20, 9));
      const ToolPath turned = make_pattern(test::turned(region, by), kind, angle + by, tool(20, 9));
      const double share = of_lines(kind) || i % 4 == 0 ? 1e-6 : 1e-4;
      EXPECT_NEAR(cutting_length(turned), cutting_length(path), share * cutting_length(path)) << i << ": " << path.name;
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
      if (const Eigen::Vector2d at = random_point(random, region); machined(region, at)) points_.push_back(at);
  }

  Met cut(const PathMove& move) {
    const Eigen::Vector2d from = move.from.head<2>(), to = move.to.head<2>(), along = direction(move);
    Met met;
    std::erase_if(points_, [&](const Eigen::Vector2d& point) {
      if (distance_to_line(from, to, point) > radius_) return false;
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

TEST(PathProperties, HaveTheMaterialOnTheSideOfTheirMilling) {
  const Region plate{box_mm(0, 0, 200, 130), {}};
  const Region with_island{box_mm(0, 0, 220, 200), {box_mm(90, 80, 130, 110)}};
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

}  // namespace
}  // namespace stillcut::test
