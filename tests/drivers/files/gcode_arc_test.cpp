// Arcs of G-code: the chords must stay on the arc that was programmed, turn its way round, and be bounded in number.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "drivers/files/arc_chords.hpp"
#include "drivers/files/gcode_file.hpp"
#include "drivers/files/input_error.hpp"
#include "tests/drivers/files/temp_folder.hpp"

namespace stillcut {
namespace {

using std::numbers::pi;

struct ArcWanted {
  const char* line;
  double centre_x, centre_y, radius, sweep_deg;  // mm; anti-clockwise positive
};

// The arc starts at X10 Y0 Z0. Fails when G2 and G3, the side of R or the sense of I and J are swapped.
TEST(GcodeArc, ChordsLieOnTheProgrammedArc) {
  const ArcWanted arcs[] = {
      {"G3 X0 Y10 I-10 J0", 0, 0, 10, 90},
      {"G2 X0 Y10 I-10 J0", 0, 0, 10, -270},
      {"G3 X-10 I-10", 0, 0, 10, 180},
      {"G2 X-10 Y0 I-10", 0, 0, 10, -180},
      {"G3 I-10", 0, 0, 10, 360},
      {"G2 X10 Y0 J5", 10, 5, 5, -360},
      {"G3 X0 Y10 R10", 0, 0, 10, 90},
      {"G3 X0 Y10 R-10", 10, 10, 10, 270},
      {"G2 X0 Y10 R10", 10, 10, 10, -90},
      {"G2 X0 Y10 R-10", 0, 0, 10, -270},
      {"G3 X-10 Y0 R10", 0, 0, 10, 180},
      {"G91 G3 X-10 Y10 I-10", 0, 0, 10, 90},
      {"G3 X0 Y10 Z-4 I-10", 0, 0, 10, 90},
      {"G3 X9.9998 Y0.02 I-9999.99 F10", -9989.99, 0, 9999.99, 0.000114592},
      {"G3 X10.02 Y0 R0.01", 10.01, 0, 0.01, 180},  // smaller than the sagitta allows a chord
  };
  for (const ArcWanted& wanted : arcs) {
    const ToolPath path = parse_gcode("G0 X10 Y0 Z0 F600 S3000 M3\nG1\n" + std::string(wanted.line) + "\n", "p.nc");
    const Eigen::Vector2d centre(wanted.centre_x, wanted.centre_y);
    double swept = 0.0, height = 0.0;
    for (const PathMove& move : path.moves) {
      const Eigen::Vector2d a = 1e3 * move.from.head<2>() - centre, b = 1e3 * move.to.head<2>() - centre;
      EXPECT_NEAR(b.norm(), wanted.radius, 0.003) << wanted.line;
      const double step = std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b));
      EXPECT_LT(wanted.radius * (1.0 - std::cos(0.5 * step)), 0.01 + 1e-6) << wanted.line;
      EXPECT_LT(std::abs(step), pi / 4 + 1e-6) << wanted.line;
      swept += step;
      height = move.to.z();
      EXPECT_TRUE(move.cutting);
      EXPECT_NEAR(move.feed_rate, std::string(wanted.line).find('F') == std::string::npos ? 0.01 : 1.0 / 6000.0, 1e-15);
    }
    EXPECT_NEAR(swept * 180 / pi, wanted.sweep_deg, 1e-4) << wanted.line;
    EXPECT_NEAR(height, std::string(wanted.line).find('Z') == std::string::npos ? 0.0 : -0.004, 1e-15);
  }
}

TEST(GcodeArc, HelixFallsEvenly) {
  const ToolPath path = parse_gcode("G0 X10 Y0 Z0 F600 S3000\nG3 X10 Y0 Z-2 I-10\n", "p.nc");
  const double count = static_cast<double>(path.moves.size());
  EXPECT_GT(count, 60);  // 10 mm: a chord covers 5.1 degrees
  EXPECT_LT(count, 80);
  for (const PathMove& move : path.moves) EXPECT_NEAR(move.to.z() - move.from.z(), -2e-3 / count, 1e-15);
  EXPECT_EQ(path.moves.back().to, Eigen::Vector3d(0.01, 0, -0.002));
}

TEST(GcodeArc, RoundedEndsArePassedEvenly) {  // radii that differ by less than 5 µm
  const ToolPath path = parse_gcode("G0 X10 Y0 Z0 F600 S3000\nG3 X0 Y10.004 I-10\n", "p.nc");
  EXPECT_EQ(path.moves.back().to, Eigen::Vector3d(0, 10.004 * 1e-3, 0));
  for (const PathMove& move : path.moves) EXPECT_LT(1e3 * move.to.norm(), 10.0040001);
}

struct ArcRefused {
  const char *line, *says;
};

TEST(GcodeArc, RefusesArcsThatAreNone) {
  const ArcRefused cases[] = {
      {"G2 X5 Y5", "an arc without its centre; give I and J, or R"},
      {"G2 Z1", "an arc without its centre"},
      {"G2 X5 Y5 I0 J0", "the arc's centre is its start"},
      {"G3 X0 Y10.02 I-10", "the arc's radius is 10 mm at its start and 10.02 mm at its end; give end and centre"},
      {"G3 X0 Y1000.2 I-1000 J0", "the arc's radius is 1000 mm at its start"},
      {"G2 X5 Y5 I1 R5", "an arc by centre and by radius"},
      {"G2 Z5 R5", "an arc by R without its end; give X and Y"},
      {"G2 X10 Y0 R5", "an arc by R ends where it began; give a full circle by I and J"},
      {"G2 X0 Y0 R4.9", "the arc's ends lie 10 mm apart, more than twice its radius of 4.9 mm"},
      {"G2 X0 Y0 R0", "the arc's ends lie 10 mm apart"},
      {"G2 I5000000000", "the arc needs more than a million chords; check its radius of 5e+09 mm"},
      {"G2 I60000", "X: lies beyond 100 m"},
      {"G2 X0 Y0 I99999999999", "I99999999999: is too large"},
  };
  for (const ArcRefused& c : cases) {
    const std::string start = c.line == std::string("G3 X0 Y1000.2 I-1000 J0") ? "X1000" : "X10";
    const std::string text = "G0 Y0 Z0 " + start + " F600 S3000\n" + c.line + "\n";
    const std::string message = message_of<InputError>([&] { (void)parse_gcode(text, "p.nc"); });
    EXPECT_TRUE(message.starts_with("p.nc:2: " + std::string(c.says))) << c.line << ": '" << message << "'";
  }
}

TEST(GcodeArc, MovesOfAllArcsTogetherAreBounded) {
  std::string text = "G0 X0 Y0 Z0 F600 S3000\n";
  for (int i = 0; i < 1000; ++i) text += "G2 I40000\n";  // about 4400 chords each
  const std::string message = message_of<InputError>([&] { (void)parse_gcode(text, "p.nc"); });
  EXPECT_NE(message.find("the path has more than 2000000 moves"), std::string::npos) << message;
}

// The most chords within the sagitta, and no fewer: one less would leave it.
TEST(GcodeArc, CountsAsFewChordsAsTheSagittaAllows) {
  for (const double radius : {1e-3, 1e-2, 0.3, 5.0}) {
    const PathArc arc = arc_about({radius, 0, 0}, {radius, 0, 0}, {0, 0}, false);
    const double count = static_cast<double>(chord_count(arc));
    EXPECT_LE(radius * (1 - std::cos(pi / count)), kChordSagitta * (1 + 1e-9));
    EXPECT_GT(radius * (1 - std::cos(pi / (count - 1))), kChordSagitta);
  }
}

}  // namespace
}  // namespace stillcut
