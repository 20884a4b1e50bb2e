// APT cutter locations: how each word is read, and what is said about those that are refused.
#include "drivers/files/cl_file.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "drivers/files/input_error.hpp"
#include "tests/drivers/files/temp_folder.hpp"

namespace stillcut {
namespace {

constexpr double kTurnAMinute = 2.0 * std::numbers::pi / 60.0;
// Three lines after which the position, feed and spindle speed are known.
const std::string kClStart = "SPINDL/RPM,3000,CLW\nFEDRAT/MMPM,600\nFROM/0,0,0\n";

ToolPath cutter_locations(const std::string& text) { return parse_cutter_locations(text, "p.cls"); }

std::string cl_error(const std::string& text) {
  return message_of<InputError>([&] { (void)cutter_locations(text); });
}

// Fails when RAPID holds for more than one motion, or the axis is not kept from GOTO to GOTO.
TEST(ClFile, ReadsPlacesAxesFeedsAndRapids) {
  const ToolPath path = cutter_locations("PARTNO any/thing, $ 1\nTOOL PATH/WAVE,TOOL,BALL\n" + kClStart +
                                         "RAPID\nGOTO/10,0,0\nGOTO/10.,20,-.5,0,3,4\ngoto / 10 , 30.0 , "
                                         "-5E-1\nMULTAX/OFF\nGODLTA/0,0,-2\nFINI\nNONSENSE\n");
  EXPECT_EQ(path.name, "WAVE");
  ASSERT_EQ(path.moves.size(), 4U);
  EXPECT_FALSE(path.moves[0].cutting);
  EXPECT_TRUE(std::isnan(path.moves[0].feed_rate));
  EXPECT_EQ(path.moves[0].tool_axis, Eigen::Vector3d::UnitZ());
  EXPECT_TRUE(path.moves[1].cutting);
  EXPECT_EQ(path.moves[1].line, 8);
  EXPECT_NEAR(path.moves[1].feed_rate, 0.01, 1e-15);
  EXPECT_NEAR(path.moves[1].spindle_speed, 3000 * kTurnAMinute, 1e-9);
  EXPECT_NEAR((path.moves[1].tool_axis - Eigen::Vector3d(0, 0.6, 0.8)).norm(), 0.0, 1e-15);
  EXPECT_NEAR((path.moves[1].to - Eigen::Vector3d(0.01, 0.02, -0.0005)).norm(), 0.0, 1e-15);
  EXPECT_EQ(path.moves[2].tool_axis, path.moves[1].tool_axis);
  EXPECT_NEAR((path.moves[2].to - Eigen::Vector3d(0.01, 0.03, -0.0005)).norm(), 0.0, 1e-15);
  EXPECT_FALSE(path.moves[3].cutting);  // straight down
  EXPECT_NEAR(path.moves[3].to.z(), -0.0025, 1e-15);
  EXPECT_NEAR(path.moves[3].feed_rate, 0.01, 1e-15);
}

TEST(ClFile, PlungeIsAlongTheToolsAxis) {
  const ToolPath path = cutter_locations(kClStart + "GOTO/0,3,4,0,0.6,0.8\nGOTO/0,0,0\nGOTO/0,0,5\n");
  EXPECT_FALSE(path.moves[0].cutting);
  EXPECT_FALSE(path.moves[1].cutting);
  EXPECT_TRUE(path.moves[2].cutting);
}

// The axis turns on the way, from where it stood: also from where it was turned on the spot, which is no move.
TEST(ClFile, AMoveBeginsWithTheAxisThatTheToolHas) {
  const ToolPath path =
      cutter_locations(kClStart + "GOTO/1,0,0,0,0.6,0.8\nGOTO/2,0,0\nGOTO/2,0,0,0,0,1\nGOTO/3,0,0,0.6,0,0.8\n");
  ASSERT_EQ(path.moves.size(), 3U);
  EXPECT_EQ(path.moves[0].axis_from, Eigen::Vector3d::UnitZ());
  EXPECT_EQ(path.moves[1].axis_from, path.moves[0].tool_axis);
  EXPECT_EQ(path.moves[2].axis_from, Eigen::Vector3d::UnitZ());
}

TEST(ClFile, ReadsEveryFormOfFeedAndSpindle) {
  struct {
    const char* line;
    double feed_mm_s;
  } const feeds[] = {{"FEDRAT/MMPM,300", 5}, {"FEDRAT/300,MMPM", 5},   {"FEDRAT/300", 5},
                     {"FEDRAT/IPM,6", 2.54}, {"FEDRAT/6.0,IPM", 2.54}, {"fedrat/mmpr,.1", 5},
                     {"FEDRAT/0.1,MMPR", 5}, {"FEDRAT/IPR,.01", 12.7}, {"UNITS/INCHES\nFEDRAT/6\nUNITS/MM", 2.54}};
  for (const auto& feed : feeds) {
    const ToolPath path = cutter_locations(kClStart + feed.line + "\nGOTO/1,0,0\n");
    EXPECT_NEAR(1e3 * path.moves[0].feed_rate, feed.feed_mm_s, 1e-12) << feed.line;
  }
  for (const char* spindle : {"SPINDL/RPM,100,CLW", "SPINDL/100,RPM", "SPINDL/100,CLW", "SPINDL/100", "SPINDL/RPM,100",
                              "SPINDL/100,RPM,CLW\nSPINDL/OFF\nSPINDL/ON"}) {
    const ToolPath path = cutter_locations(kClStart + spindle + "\nGOTO/1,0,0\n");
    EXPECT_NEAR(path.moves[0].spindle_speed, 100 * kTurnAMinute, 1e-12) << spindle;
  }
  // A feed per turn follows the speed.
  EXPECT_NEAR(1e3 * cutter_locations(kClStart + "FEDRAT/MMPR,.1\nSPINDL/6000\nGOTO/1,0,0\n").moves[0].feed_rate, 10.0,
              1e-12);
}

TEST(ClFile, ReadsInches) {
  const ToolPath path = cutter_locations("UNITS/INCH\nFEDRAT/6\nSPINDL/100\nGOTO/1,0,0\nGOTO/2,0,0\n");
  ASSERT_EQ(path.moves.size(), 1U);
  EXPECT_NEAR(path.moves[0].from.x(), 0.0254, 1e-15);
  EXPECT_NEAR(path.moves[0].to.x(), 0.0508, 1e-15);
}

TEST(ClFile, EachToolPathBeginsWithoutCutting) {
  const ToolPath path = cutter_locations(kClStart + "GOTO/1,0,0,0,1,0\nTOOL PATH/B\nGOTO/9,9,9\nGOTO/8,9,9\n");
  ASSERT_EQ(path.moves.size(), 3U);
  EXPECT_FALSE(path.moves[1].cutting);
  EXPECT_TRUE(path.moves[2].cutting);
  EXPECT_EQ(path.moves[2].tool_axis, Eigen::Vector3d::UnitZ());
}

TEST(ClFile, FromOnTheWayIsReachedWithoutCutting) {
  const ToolPath path = cutter_locations(kClStart + "GOTO/1,0,0\nRAPID\nFROM/5,0,0\nGOTO/6,0,0\nGOTO/7,0,0\n");
  ASSERT_EQ(path.moves.size(), 4U);
  EXPECT_FALSE(path.moves[1].cutting);
  EXPECT_EQ(path.moves[2].from, path.moves[1].to);
  EXPECT_FALSE(path.moves[2].cutting);  // RAPID waits for the next motion
  EXPECT_TRUE(path.moves[3].cutting);
}

TEST(ClFile, JoinsContinuedLinesAndSkipsComments) {
  const ToolPath path = cutter_locations("$$ comment, GOTO/1\n" + kClStart +
                                         "GOTO/1,$ to be continued\n 2,$\r\n\t3 $$ done\n\nGOTO/2,2,3\n");
  ASSERT_EQ(path.moves.size(), 2U);
  EXPECT_NEAR((1e3 * path.moves[0].to - Eigen::Vector3d(1, 2, 3)).norm(), 0.0, 1e-12);
  EXPECT_EQ(path.moves[0].line, 5);
  EXPECT_EQ(path.moves[1].line, 9);
}

TEST(ClFile, TakesWhatMovesNoTool) {
  const std::string idle =
      "PPRINT here: $ 5, a/b\nMACHIN/MILL,1\nMSYS/0,0,0,1.0,0,0,0,1.0,0\nTLDATA/MILL,25,0,75,0,0\nCUTTER/25\nLOADTL/1\n"
      "LOAD/TOOL,1\nTOOLNO/1\nSELECT/TOOL,2\nCOOLNT/ON\nPAINT/PATH\nOPSKIP/ON\nOPSTOP\nSTOP\nDELAY/1\nCUTCOM/OFF\n"
      "INTOL/.01\nOUTTOL/.01\nMULTAX\nMULTAX/ON\nTPRINT/T1\nEND-OF-PATH\nREMARK what/ever\nUNITS/MM\n";
  EXPECT_EQ(cutter_locations(idle + kClStart + "GOTO/1,0,0\n").moves.size(), 1U);
}

struct ClCase {
  const char *line, *says;
};

// Every case stands in line 4, behind a start that alone would do.
TEST(ClFile, RefusesWithFileLineWordAndWhatToDo) {
  const ClCase cases[] = {
      {"CIRCLE/0,0,0,0,0,-1,5,.01,.5,10,0", "CIRCLE: arcs are not read, as their sense is not certain; let the CAM"},
      {"CYCLE/DRILL,5", "CYCLE: cycles are not read; let the CAM system write their moves"},
      {"CUTCOM/LEFT", "CUTCOM: the tool's radius moves the path"},
      {"INSERT G28", "INSERT: hands the controller text of its own"},
      {"PREFUN/28", "PREFUN: hands the controller a G word"},
      {"GOHOME", "GOHOME: goes to a place that the file does not tell; remove it"},
      {"RETRCT", "RETRCT: goes to a place"},
      {"TRACUT/M", "TRACUT: moves the path"},
      {"ORIGIN/1,2,3", "ORIGIN: moves the path"},
      {"ROTATE/TABLE,90", "ROTATE: turns the workpiece"},
      {"CALL/M1", "CALL: calls a macro"},
      {"TLLFT,GOFWD/C1", "TLLFT,GOFWD: is not known to leave the tool's way as written; remove it"},
      {"Dear colleagues", "DEAR COLLEAGUES: is not known"},
      {"/1", ": is not known"},
      {"MSYS/0,0,5,1,0,0,0,1,0", "MSYS: a coordinate system other than the workpiece's; set it to 0,0,0, 1,0,0, 0,1,0"},
      {"MSYS/0,0,0", "MSYS: a coordinate system other"},
      {"GOTO/1,2", "GOTO: has 2 items; give x,y,z or x,y,z,i,j,k"},
      {"GOTO/1,2,3,4", "GOTO: has 4 items"},
      {"GOTO", "GOTO: has 0 items"},
      {"GOTO/P1", "GOTO: has 1 items"},
      {"GOTO/1,2,z", "GOTO: \"Z\" is no number; give one with a dot"},
      {"GOTO/1,,3", "GOTO: \"\" is no number"},
      {"GOTO/1,2,nan", "GOTO: \"NAN\" is no number"},
      {"GOTO/1,2,1e999", "GOTO: \"1E999\" is no number"},
      {"GOTO/1,2,3,0,0,0", "GOTO: the tool's axis has no length; give i,j,k"},
      {"GOTO/1,2,3,0,0,inf", "GOTO: \"INF\" is no number"},
      {"GOTO/1,-1e6,3", "Y: lies beyond 100 m"},
      {"GODLTA/5", "GODLTA: has 1 items; give dx,dy,dz"},
      {"TOOL PATH/B\nGODLTA/1,0,0", "GODLTA: a step before the position is known; begin with FROM or GOTO"},
      {"FEDRAT/0", "FEDRAT: a feed must be above 0"},
      {"FEDRAT/MMPM", "FEDRAT: a feed must be above 0"},
      {"FEDRAT/MMPM,-1", "FEDRAT: a feed must be above 0"},
      {"FEDRAT/5,FPM", "FEDRAT: \"FPM\" is no unit of feed; give MMPM, IPM, MMPR or IPR"},
      {"FEDRAT/1e9", "FEDRAT: a feed above 100 m/s"},
      {"SPINDL/RPM,100,CCLW", "SPINDL: an anti-clockwise spindle would swap up and down milling; let it turn CLW"},
      {"SPINDL/SFM,100", "SPINDL: \"SFM\" is not known; give RPM, the speed and CLW, or OFF"},
      {"SPINDL/RPM,-5", "SPINDL: a spindle speed below 0"},
      {"UNITS/CM", "UNITS: is not known; give UNITS/MM or UNITS/INCHES"},
      {"UNITS", "UNITS: is not known"},
      {"MULTAX/MAYBE", "MULTAX: is not known; give MULTAX/ON or MULTAX/OFF"},
      {"SPINDL/OFF\nGOTO/1,0,0", "a feed move while the spindle stands still; start the spindle before it"},
  };
  for (const ClCase& c : cases) {
    const std::string message = cl_error(kClStart + c.line + "\nGOTO/5,0,0\n");
    const std::string place = std::string(c.line).find('\n') == std::string::npos ? "p.cls:4: " : "p.cls:5: ";
    EXPECT_TRUE(message.starts_with(place + c.says)) << c.line << ": '" << message << "'";
    EXPECT_LT(message.size(), 220U);
  }
  EXPECT_TRUE(cl_error(kClStart + "GOTO/1,2,$").starts_with("p.cls:4: the file ends where $ announces a further line"));
  EXPECT_TRUE(cl_error(kClStart + "PAINT/" + std::string(2000, ',')).starts_with("p.cls:4: more than 1000 items"));
  std::string endless = "GOTO/1";
  for (int i = 0; i < 200; ++i) endless += ",$\n1";
  EXPECT_TRUE(cl_error(kClStart + endless).starts_with("p.cls:4: more than 100 lines in one statement"));
}

TEST(ClFile, RefusesMovesBeforeTheyAreSaid) {
  const ClCase cases[] = {
      {"GODLTA/1,0,0\n", "p.cls:1: GODLTA: a step before the position is known; begin with FROM or GOTO"},
      {"GOTO/0,0,0\nGOTO/1,0,0\n", "p.cls:2: GOTO: a feed move before its feed is known; give FEDRAT before it"},
      {"FEDRAT/MMPR,.1\nGOTO/0,0,0\nGOTO/1,0,0\n", "p.cls:3: GOTO: a feed per turn before the spindle speed is known"},
      {"FEDRAT/9\nSPINDL/OFF\nGOTO/0,0,0\nGOTO/1,0,0\n", "p.cls:4: a feed move while the spindle stands still"},
      {"", "p.cls: holds no move; give GOTO statements"},
      {"FINI\nGOTO/0,0,0\nGOTO/0,0,1\n", "p.cls: holds no move"},
  };
  for (const ClCase& c : cases) {
    const std::string message = cl_error(c.line);
    EXPECT_TRUE(message.starts_with(c.says)) << c.line << ": '" << message << "'";
  }
}

TEST(ClFile, ReadsTheExampleSurface) {
  const ToolPath path = read_cutter_locations(TEST_DATA "/paths/wave.cls");
  EXPECT_EQ(path.name, "WAVE_FINISH");
  ASSERT_EQ(path.moves.size(), 101U);  // 4 rows of 25 places, reached and left
  EXPECT_FALSE(path.moves.front().cutting);
  EXPECT_FALSE(path.moves.back().cutting);
  for (std::size_t i = 1; i + 1 < path.moves.size(); ++i) {
    const PathMove& move = path.moves[i];
    EXPECT_TRUE(move.cutting);
    EXPECT_NEAR(move.feed_rate, 0.02, 1e-12);
    EXPECT_NEAR(move.tool_axis.norm(), 1.0, 1e-15);
    // The axis is the surface's normal, z = 3 sin(x/15) + 2 cos(y/20) in mm.
    const Eigen::Vector3d at = 1e3 * move.to;
    const Eigen::Vector3d normal(-0.2 * std::cos(at.x() / 15), 0.1 * std::sin(at.y() / 20), 1.0);
    EXPECT_LT((move.tool_axis - normal.normalized()).norm(), 1e-6);
  }
}

}  // namespace
}  // namespace stillcut
