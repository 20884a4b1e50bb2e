// G-code: how each word is read, and what is said about those that are refused.
#include "drivers/files/gcode_file.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "drivers/files/input_error.hpp"
#include "tests/drivers/files/temp_folder.hpp"

namespace stillcut {
namespace {

constexpr double kRpm = 2.0 * std::numbers::pi / 60.0;
// Three lines after which the position, feed and spindle speed are known.
const std::string kGcodeStart = "G21 G90 G94 F600 S3000 M3\nG0 X0 Y0\nZ0\n";

ToolPath gcode(const std::string& text) { return parse_gcode(text, "p.nc"); }

std::string gcode_error(const std::string& text) {
  return message_of<InputError>([&] { (void)gcode(text); });
}

Eigen::Vector3d end_mm(const std::string& text) { return 1e3 * gcode(text).moves.back().to; }

// Fails when a default, a unit, or the sense of cutting and rapid is changed.
TEST(GcodeFile, ReadsLinesRapidsAndPlunges) {
  const ToolPath path = gcode("G0 X10 Y20\nZ5 S3000 M3\nG1 Z-1 F300\nX40.5 F600\nG0 Z5\n");
  EXPECT_EQ(path.name, "p");
  ASSERT_EQ(path.moves.size(), 3U);
  const PathMove &plunge = path.moves[0], &cut = path.moves[1], &lift = path.moves[2];
  EXPECT_EQ(plunge.from, Eigen::Vector3d(0.01, 0.02, 0.005));
  EXPECT_FALSE(plunge.cutting);
  EXPECT_NEAR(plunge.feed_rate, 0.005, 1e-15);
  EXPECT_TRUE(cut.cutting);
  EXPECT_EQ(cut.line, 4);
  EXPECT_NEAR((cut.to - Eigen::Vector3d(0.0405, 0.02, -0.001)).norm(), 0.0, 1e-15);
  EXPECT_NEAR(cut.feed_rate, 0.01, 1e-15);
  EXPECT_NEAR(cut.spindle_speed, 3000 * kRpm, 1e-9);
  EXPECT_EQ(cut.tool_axis, Eigen::Vector3d::UnitZ());
  EXPECT_FALSE(cut.milling);
  EXPECT_FALSE(lift.cutting);
  EXPECT_TRUE(std::isnan(lift.feed_rate));
  for (std::size_t i = 1; i < path.moves.size(); ++i) EXPECT_EQ(path.moves[i].from, path.moves[i - 1].to);
}

// The path begins where all three axes are known; each spelling is one that posts write.
TEST(GcodeFile, TakesEverySpellingOfAWord) {
  const Eigen::Vector3d wanted(12.0, -0.5, 3.0);
  for (const char* line : {"G1 X12 Y-.5 Z3", "g01x12.y-0.5z3.", "Z+3. Y -.5 X 12 G1",
                           "N5 G001 X012.000 Y-0.50 Z3.0 ;end", "/G1 X12(a) Y-.5 (G0 X99) Z3", "/2 G1 X12 Y-.5 Z3",
                           "\tG1\tX12\tY-.5\tZ3\r", "G90 X12 G17 Y-.5 G94 G1 Z3 T4 M8 H2"}) {
    EXPECT_NEAR((end_mm(kGcodeStart + line + "\n") - wanted).norm(), 0.0, 1e-9) << line;
  }
}

TEST(GcodeFile, ReadsInchesAndIncrements) {
  const ToolPath path = gcode("G20 G0 X1 Y0 Z0\nG91 G1 X1 F6 S100\nX-.5 Y.5\nG21 X10\nG90 X0\n");
  ASSERT_EQ(path.moves.size(), 4U);
  EXPECT_NEAR(path.moves[0].to.x(), 2 * 0.0254, 1e-15);
  EXPECT_NEAR(path.moves[0].feed_rate, 6 * 0.0254 / 60.0, 1e-15);
  EXPECT_NEAR((path.moves[1].to - Eigen::Vector3d(1.5 * 0.0254, 0.5 * 0.0254, 0)).norm(), 0.0, 1e-15);
  EXPECT_NEAR(path.moves[2].to.x(), 1.5 * 0.0254 + 0.01, 1e-15);
  EXPECT_NEAR(path.moves[2].feed_rate, 6 * 0.0254 / 60.0, 1e-15);  // a feed stays what it was
  EXPECT_EQ(path.moves[3].to.x(), 0.0);
}

TEST(GcodeFile, ReadsFeedPerTurn) {
  const ToolPath path = gcode("G0 X0 Y0 Z0\nG95 F0.1 S3000 M3\nG1 X10\nS6000\nX20\nG94 F100 X30\n");
  EXPECT_NEAR(path.moves[0].feed_rate, 0.1e-3 * 50.0, 1e-15);
  EXPECT_NEAR(path.moves[1].feed_rate, 0.1e-3 * 100.0, 1e-15);
  EXPECT_NEAR(path.moves[2].feed_rate, 0.1 / 60.0, 1e-15);
}

TEST(GcodeFile, SpindleStopsWhenTheLinesMoveIsDone) {
  const ToolPath path = gcode(kGcodeStart + "G1 X10 M5\nG0 Z5\nM3 X20\n");
  EXPECT_NEAR(path.moves[0].spindle_speed, 3000 * kRpm, 1e-9);
  EXPECT_EQ(path.moves[1].spindle_speed, 0.0);
  EXPECT_NEAR(path.moves[2].spindle_speed, 3000 * kRpm, 1e-9);
  EXPECT_NEAR(gcode("G0 X0 Y0 Z0 S100\nG1 X1 F1\n").moves[0].spindle_speed, 100 * kRpm, 1e-9);  // M3 by hand
  EXPECT_TRUE(std::isnan(gcode("G0 X0 Y0 Z0\nG1 X1 F1\n").moves[0].spindle_speed));
}

TEST(GcodeFile, TakesWhatLeavesThePathAsItIs) {
  const std::string idle =
      "%\nO1001 (name)\nG17 G40 G49 G80 G15 G69 G97 G98\nG61\nG61.1\nG64 P0.01 Q0.02\nG91.1 G43 H1\nG54\nG54\n"
      "G4 P1.5\nT2 M6\nM0\nM1\nM7 M8\nM9\nD3\n\n(only a comment)\n; and another\n";
  const ToolPath path = gcode(idle + kGcodeStart + "G1 X1\n");
  ASSERT_EQ(path.moves.size(), 1U);
  EXPECT_EQ(path.moves[0].line, 23);
  EXPECT_EQ(gcode("G56 G0 X0 Y0 Z0\nG56 X1\nM0\nG4 P1\nX2\n").moves.size(), 2U);
}

TEST(GcodeFile, EndsWithTheProgram) {
  for (const char* end : {"M2\nG18 @", "M30\n%\nO2 sub", "%\nanything"})
    EXPECT_EQ(gcode("%\n" + kGcodeStart + "G1 X1\n" + end).moves.size(), 1U) << end;
  EXPECT_EQ(gcode(kGcodeStart + "G1 X1 M30\nX2").moves.size(), 1U);  // the line's own move is made
}

struct GcodeCase {
  const char *line, *says;
};

// Every case stands in line 4, behind a start that alone would do.
TEST(GcodeFile, RefusesWithFileLineWordAndWhatToDo) {
  const GcodeCase cases[] = {
      {"G18", "G18: arcs are read in the XY plane only; post G17, or lines"},
      {"G19 G2 Y1 J1", "G19: arcs are read in the XY plane only"},
      {"G93", "G93: feed as inverse time; post feed per minute (G94)"},
      {"G41 D1", "G41: the tool's radius moves the path; let the CAM system write the way of the tool's centre"},
      {"G42", "G42: the tool's radius moves the path"},
      {"G43.4 H1", "G43.4: tool axes are not read from G-code"},
      {"G81 X1 R2 Z-3", "G81: canned cycles are not read; post G0 and G1"},
      {"G73 X1", "G73: canned cycles are not read"},
      {"G28 G91 Z0", "G28: goes to a place that the program does not tell; remove the line"},
      {"G30", "G30: goes to a place"},
      {"G53 G0 Z0", "G53: goes to a place"},
      {"G92 X0", "G92: moves the origin; post the path in the coordinates of one workpiece offset"},
      {"G52 X0", "G52: moves the origin"},
      {"G10 L2 P1 X0", "G10: moves the origin"},
      {"G55", "G55: the workpiece offset changes, by how much is not in the program; split it there"},
      {"G90.1", "G90.1: arc centres in absolute coordinates; post I and J"},
      {"G65 P1", "G65: calls a subprogram"},
      {"G96 S100", "G96: a spindle speed that follows the radius; post G97"},
      {"G5 X1", "G5: splines are not read"},
      {"G12", "G12: is not known to leave the tool's way as written; remove it or post without it"},
      {"G-1", "G-1: is not known"},
      {"G1.25", "G1.25: is not known"},
      {"M4", "M4: an anti-clockwise spindle would swap up and down milling; post M3"},
      {"M98 P1000", "M98: calls a subprogram"},
      {"M99", "M99: calls a subprogram"},
      {"M48", "M48: is not known"},
      {"G1 X1 A5", "A5: rotary axes are not read from G-code; post three axes, or give cutter locations (.cls)"},
      {"B0", "B0: rotary axes"},
      {"C1", "C1: rotary axes"},
      {"W1", "W1: second linear axes are not read"},
      {"G2 X1 K1", "K1: arcs are read in the XY plane only; give their centre by I and J"},
      {"E1", "E1: is no word that is known"},
      {"O100 sub", "O: subprograms and loops are not followed"},
      {"o<drill> call", "O: subprograms and loops are not followed"},
      {"O2000", "O2000: a second program or a subprogram begins"},
      {"#1=5", "variables and expressions (#, [ ], < >) are not evaluated"},
      {"X#1", "variables and expressions"},
      {"X[1+2]", "variables and expressions"},
      {"G1 X1 @", "'@' begins no word of G-code"},
      {"G1 X1)", "')' begins no word of G-code"},
      {"X1 / Y2", "'/' begins no word of G-code"},
      {"G1 X1 (half a comment", "a comment is not closed; add ')'"},
      {"G1 X", "X is followed by no number"},
      {"G1 XNAN", "X is followed by no number"},
      {"G1 X1.2.3", "X1.2.3: is no number; write digits with one point"},
      {"G1 X--1", "X--1: is no number"},
      {"G1 X+-1", "X+-1: is no number"},
      {"G1 X.", "X.: is no number"},
      {"G1 X1 2", "the number 2 has no letter"},
      {"12", "the number 12 has no letter"},
      {"G1 X100001", "X: lies beyond 100 m; check the number and the unit"},
      {"G1 X1 X2", "X2: X stands twice in the line; remove one"},
      {"G0 G1 X1", "G1: contradicts G0 in the same line"},
      {"G90 G91", "G91: contradicts G90 in the same line"},
      {"M3 M5", "M5: M3 and M5 in one line"},
      {"G1 X1 F0", "F: a feed must be above 0; give the feed rate"},
      {"F-5", "F: a feed must be above 0"},
      {"F99999999", "F: a feed above 100 m/s"},
      {"S-5", "S: a spindle speed below 0"},
      {"S1000001", "S: a spindle speed above a million rpm"},
      {"P5", "P: belongs to G4 or G64; remove it"},
      {"G4 P1 Q5", "Q: belongs to G64; remove it"},
      {"G4 X5", "G4: a dwell with an axis word; give its time by P"},
      {"G80 X5", "an axis word while no motion is in effect; add G0, G1, G2 or G3"},
      {"G1 X5 I1", "I, J and R belong to arcs (G2, G3)"},
      {"G95 G1 X1", "a feed move before its feed is known; add F"},
  };
  for (const GcodeCase& c : cases) {
    const std::string message = gcode_error(kGcodeStart + c.line + "\nG0 X1\n");
    EXPECT_TRUE(message.starts_with("p.nc:4: " + std::string(c.says))) << c.line << ": '" << message << "'";
    EXPECT_LT(message.size(), 200U);
  }
  EXPECT_TRUE(
      gcode_error(kGcodeStart + "G1 X1" + std::string(400, '0') + "\n").starts_with("p.nc:4: X100000000000000"));
  std::string words;
  for (int i = 0; i < 101; ++i) words += "M8";
  EXPECT_EQ(gcode_error(kGcodeStart + words), "p.nc:4: more than 100 words in one line; is it G-code?");
}

TEST(GcodeFile, RefusesMovesBeforeTheyAreSaid) {
  const GcodeCase cases[] = {
      {"G0 X0 Y0\nG1 X1 F1 S1\n", "p.nc:2: a feed move before the position is known in X, Y and Z"},
      {"G1 X0 Y0 Z0 F1 S1\n", "p.nc:1: a feed move before the position is known"},
      {"G91 G0 X1\n", "p.nc:1: X: an incremental move before the position is known; begin with G90"},
      {"X1\n", "p.nc:1: an axis word while no motion is in effect"},
      {"G0 X0 Y0 Z0\nG1 X1\n", "p.nc:2: a feed move before its feed is known; add F"},
      {"G0 X0 Y0 Z0\nG95 F.1\nG1 X1\n", "p.nc:3: a feed per turn (G95) before the spindle speed is known; add S"},
      {"G0 X0 Y0 Z0 S100 M3\nM5\nG1 X1 F1\n", "p.nc:3: a feed move while the spindle stands still"},
      {"G0 X0 Y0 Z0 S0 M3\nG1 X1 F1\n", "p.nc:2: a feed move while the spindle stands still"},
      {"G0 X0\nG55\nY0 Z0\n", "p.nc:2: G55: the workpiece offset changes"},
      {"", "p.nc: holds no move; give a program with G0 and G1 moves"},
      {"%\n%\nG0 X0 Y0 Z0\nX1\n", "p.nc: holds no move"},
  };
  for (const GcodeCase& c : cases) {
    const std::string message = gcode_error(c.line);
    EXPECT_TRUE(message.starts_with(c.says)) << c.line << ": '" << message << "'";
  }
}

TEST(GcodeFile, ReadsTheExampleFace) {
  const ToolPath path = read_gcode(TEST_DATA "/paths/face.nc");
  EXPECT_EQ(path.name, "face");
  double cut = 0.0;
  for (const PathMove& move : path.moves) cut += move.cutting ? (move.to - move.from).norm() : 0.0;
  const double turns = 2.0 * std::numbers::pi * 10.0 + 0.5 * std::numbers::pi * 10.0;
  EXPECT_NEAR(cut * 1e3, 130.0 + 100.0 + 110.0 + 10.0 + turns, 0.1);  // chords are a little shorter
  EXPECT_NEAR(path.moves.back().spindle_speed, 3420 * kRpm, 1e-9);
  EXPECT_NEAR((1e3 * path.moves.back().to - Eigen::Vector3d(130, 70, 50)).norm(), 0.0, 1e-9);
}

TEST(GcodeFile, MissingFileIsNamed) {
  EXPECT_NE(message_of<InputError>([] { (void)read_gcode("/nowhere/p.nc"); }).find("no such file"), std::string::npos);
}

}  // namespace
}  // namespace stillcut
