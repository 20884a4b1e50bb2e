// Written programs: what they say word by word, and that reading them gives the path again.
#include "drivers/files/gcode_writer.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <sstream>
#include <stdexcept>
#include <string>

#include "drivers/files/gcode_file.hpp"
#include "tests/drivers/files/temp_folder.hpp"

namespace stillcut {
namespace {

constexpr double kRadiansPerRpm = 2.0 * std::numbers::pi / 60.0;
constexpr double kNotGiven = std::numeric_limits<double>::quiet_NaN();

std::string written(const ToolPath& path, const GcodeHeader& header = {}) {
  std::ostringstream out;
  write_gcode(path, out, header);
  return out.str();
}

// A path by its corners in mm; feed in mm/min (NaN: rapid), spindle speed in rpm.
struct Corner {
  Eigen::Vector3d at;
  double feed, speed;
};

ToolPath path_through(const Eigen::Vector3d& start, const std::vector<Corner>& corners) {
  ToolPath path;
  Eigen::Vector3d from = 1e-3 * start;
  for (const Corner& corner : corners) {
    PathMove move;
    move.from = from;
    move.to = from = 1e-3 * corner.at;
    move.cutting = !std::isnan(corner.feed) && (move.to - move.from).head<2>().norm() > 0.0;
    move.feed_rate = corner.feed / 60e3;
    move.spindle_speed = corner.speed * kRadiansPerRpm;
    path.moves.push_back(move);
  }
  return path;
}

ToolPath written_example() {
  return path_through({0, 0, 5}, {{{0, 0, -0.5}, 200, 3330},
                                  {{120.25, 0, -0.5}, 333, 3330},
                                  {{120.25, 30.0001, -0.5}, 342.25, 3420},
                                  {{120.25, 30.0001, 5}, kNotGiven, 3420}});
}

// Fails when a word is left out, repeated, or written in another form.
TEST(GcodeWriter, WritesOnlyTheWordsThatChange) {
  const GcodeHeader header{"zig 45 (best)", {"ASI 96.5 %"}, {{1, "row 1"}, {2, "row 2; faster"}, {4, "never"}}};
  EXPECT_EQ(written(written_example(), header),
            "%\n(zig 45 [best])\n(ASI 96.5  )\n"
            "(millimetres, feed in mm/min, spindle in rpm. Feed and spindle speed are set segment by segment)\n"
            "G21 G17 G90 G94\nG40 G49 G80\nS3330 M3\nG0 X0. Y0.\nZ5.\nG1 Z-0.5 F200.\n(row 1)\nX120.25 F333.\n"
            "(row 2  faster)\nY30.0001 F342.25 S3420\nG0 Z5.\nM5\nM30\n%\n");
}

void expect_same_path(const ToolPath& path, const ToolPath& read) {
  ASSERT_EQ(read.moves.size(), path.moves.size());
  for (std::size_t i = 0; i < path.moves.size(); ++i) {
    const PathMove &wanted = path.moves[i], &found = read.moves[i];
    EXPECT_LT((found.from - wanted.from).cwiseAbs().maxCoeff(), 1e-7) << i;
    EXPECT_LT((found.to - wanted.to).cwiseAbs().maxCoeff(), 1e-7) << i;
    EXPECT_EQ(found.cutting, wanted.cutting) << i;
    EXPECT_EQ(std::isnan(found.feed_rate), std::isnan(wanted.feed_rate)) << i;
    if (!std::isnan(wanted.feed_rate)) {
      EXPECT_NEAR(found.feed_rate * 60e3, wanted.feed_rate * 60e3, 0.00501) << i;
    }
    if (!std::isnan(wanted.spindle_speed)) {
      EXPECT_NEAR(found.spindle_speed, wanted.spindle_speed, 0.501 * kRadiansPerRpm) << i;
    }
  }
}

TEST(GcodeWriter, ReadsBackAsTheSamePath) {
  expect_same_path(written_example(), parse_gcode(written(written_example()), "p.nc"));
  // The face's chords, through the file.
  const TempFolder folder;
  const ToolPath face = read_gcode(TEST_DATA "/paths/face.nc");
  expect_same_path(face, read_gcode(folder.write("again.nc", written(face))));
}

TEST(GcodeWriter, RandomPathsReadBackAsTheSame) {
  std::mt19937_64 random(8);
  std::uniform_real_distribution<double> place(-2000, 2000), feed(0.02, 20000), speed(0.6, 60000);
  std::uniform_int_distribution<int> kind(0, 3), some(1, 60);
  for (int path = 0; path < 300; ++path) {
    std::vector<Corner> corners;
    Eigen::Vector3d at(place(random), place(random), place(random));
    const Eigen::Vector3d start = at;
    double rate = feed(random), turns = speed(random);
    for (int i = some(random); i > 0; --i) {
      const int k = kind(random);
      if (k != 0) at.head<2>() = Eigen::Vector2d(place(random), place(random));
      if (k != 1) at.z() = place(random);
      if (k == 2) rate = feed(random), turns = speed(random);
      corners.push_back({at, k == 3 ? kNotGiven : rate, k == 3 && path % 2 == 0 ? kNotGiven : turns});
    }
    const ToolPath made = path_through(start, corners);
    expect_same_path(made, parse_gcode(written(made), "p.nc"));
    if (HasFailure()) FAIL() << "path " << path << ":\n" << written(made);
  }
}

TEST(GcodeWriter, WritesSmallAndNegativeNumbersInFull) {
  const std::string text = written(path_through({-0.05, 0.00004, -0.00006}, {{{100, 0, 0}, 0.05, 1}}));
  EXPECT_NE(text.find("X-0.05 Y0.\nZ-0.0001\nG1 X100. Z0. F0.05\n"), std::string::npos) << text;
}

TEST(GcodeWriter, LeavesOutMovesWithoutLengthAndASpindleThatNobodyNamed) {
  const ToolPath path =
      path_through({0, 0, 0}, {{{0.00004, 0, 0}, kNotGiven, kNotGiven}, {{5, 0, 0}, kNotGiven, kNotGiven}});
  const std::string text = written(path);
  EXPECT_EQ(text.find("M3\n"), std::string::npos);
  EXPECT_EQ(text.find("M5"), std::string::npos);
  EXPECT_NE(text.find("Z0.\nX5.\nM30"), std::string::npos) << text;
}

TEST(GcodeWriter, RefusesWhatAControlCouldNotMill) {
  const auto error = [](auto&& spoil) {
    ToolPath path = written_example();
    spoil(path.moves);
    return message_of<std::invalid_argument>([&] { (void)written(path); });
  };
  using Moves = std::vector<PathMove>;
  EXPECT_EQ(error([](Moves& m) { m.clear(); }), "the path has no move");
  EXPECT_EQ(error([](Moves& m) { m[1].feed_rate = kNotGiven; }), "move 1 has no feed rate");
  EXPECT_EQ(error([](Moves& m) { m[1].feed_rate = 1e-9; }), "move 1 has no feed rate");
  EXPECT_EQ(error([](Moves& m) { m[0].feed_rate = 0.0; }), "move 0 has no feed rate");
  EXPECT_EQ(error([](Moves& m) { m[1].feed_rate = -0.01; }), "move 1 has no feed rate");
  EXPECT_EQ(error([](Moves& m) { m[1].spindle_speed = kNotGiven; }), "move 1 has no spindle speed");
  EXPECT_EQ(error([](Moves& m) { m[1].spindle_speed = 0.01; }), "move 1 has no spindle speed");
  EXPECT_EQ(error([](Moves& m) { m[3].spindle_speed = 1e300; }), "move 3 has no spindle speed");
  EXPECT_EQ(error([](Moves& m) { m[2].tool_axis = Eigen::Vector3d(0.01, 0, 1).normalized(); }),
            "move 2 has a tilted tool; plain G-code keeps it along Z");
  EXPECT_EQ(error([](Moves& m) { m[2].tool_axis.setZero(); }),
            "move 2 has a tilted tool; plain G-code keeps it along Z");
  EXPECT_EQ(error([](Moves& m) { m[2].from.x() += 2e-6; }), "move 2 begins away from the end before it");
  EXPECT_EQ(error([](Moves& m) { m[3].to.z() = kNotGiven; }),
            "move 3 has a coordinate that is no number or beyond 100 m");
  EXPECT_EQ(error([](Moves& m) { m[3].to.z() = 101; }), "move 3 has a coordinate that is no number or beyond 100 m");
}

TEST(GcodeWriter, CommentsStayOneLineOfPlainLetters) {
  GcodeHeader header;
  header.name = "a\nG0 X1\xC3\xA4" + std::string(300, 'x');
  const std::string text = written(written_example(), header);
  EXPECT_NE(text.find("%\n(a G0 X1  x"), std::string::npos);
  EXPECT_EQ(text.substr(2, text.find('\n', 2) - 2).size(), 202U);
}

}  // namespace
}  // namespace stillcut
