// Each tool path pattern: its numbers in plain regions, its names, and what is refused.
#include "models/path_patterns.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "tests/models/pattern_cases.hpp"

namespace stillcut::test {
namespace {

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
    EXPECT_NEAR(cutting_length(path), 23 * 0.275, 1e-6) << angle;
  }
  // 275 mm is no multiple of 7 mm: 40 steps of 6.875 mm.
  EXPECT_NEAR(cutting_length(make_pattern(square(), PatternKind::zig, 0.0, tool(25, 7))), 41 * 0.275, 1e-6);
}

TEST(PathPatterns, AFaceIsCutUpToItsEdgeAndAroundIslands) {
  PatternSettings settings = tool(25, 12.5);
  settings.face = true;
  const ToolPath path = make_pattern(square(), PatternKind::zig, 0.0, settings);
  EXPECT_NEAR(cutting_length(path), 25 * 0.3, 1e-6);
  const Region island{square().polygon, {box_mm(100, 100, 200, 200)}};
  const ToolPath loops = make_pattern(island, PatternKind::periphery_in, 0.0, settings);
  EXPECT_LT(distance_to_cuts(loops, {0.3, 0.3}), 1e-6);
  EXPECT_NEAR(distance_to_cuts(loops, {0.2, 0.15}), 12.5e-3, 1e-6);
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
  const Region slot{box_mm(0, 0, 300, 24), {}};
  EXPECT_THAT(refusal(slot, tool(25, 5)), StartsWith("the tool, 25 mm across, does not fit into the region, whose "
                                                     "widest place takes 2"));
  EXPECT_THAT(refusal(slot, tool(25, 5)), HasSubstr("; take a smaller tool"));
  EXPECT_THAT(refusal({slot.polygon, {box_mm(-5, 5, 10, 10)}}, tool(5, 2)), HasSubstr("island 1 meets the polygon"));
  EXPECT_THAT(refusal(square(), tool(0, 5)), HasSubstr("cuts nothing"));
  EXPECT_THAT(refusal(square(), tool(25, 25.001)), HasSubstr("up to the tool's diameter, 25 mm"));
  EXPECT_THAT(refusal(square(), tool(25, 0)), HasSubstr("a step over of 0 mm is out of range"));
  EXPECT_THAT(refusal(square(), tool(25, 0.001)), HasSubstr("more than 10000 passes"));
  EXPECT_THAT(refusal(square(), tool(25, 5, Milling::slot)), HasSubstr("down or up"));
}

}  // namespace
}  // namespace stillcut::test
