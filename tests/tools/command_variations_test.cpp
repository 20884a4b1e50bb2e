// `stillcut directions --redundancy --placement`: the robot turned about the tool's axis, the part moved before it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "drivers/files/csv.hpp"
#include "drivers/files/dynamics_map_file.hpp"
#include "tests/tools/robot_cell.hpp"

namespace stillcut {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;

std::vector<std::vector<std::string>> rows_of(const Finished& done) {
  EXPECT_EQ(done.exit_code, 0) << done.err;
  std::vector<std::vector<std::string>> rows;
  const CsvTable table = parse_csv(done.out, "stdout");
  for (const CsvRow& row : table.rows()) rows.push_back(row.fields);
  return rows;
}

// The limits of the rows that `like` is true of.
template <class Like>
std::vector<double> limits_of(const std::vector<std::vector<std::string>>& rows, Like like) {
  std::vector<double> limits;
  for (const auto& row : rows)
    if (like(row)) limits.push_back(std::stod(row[2]));
  return limits;
}

void expect_near(const std::vector<double>& a, const std::vector<double>& b) {
  ASSERT_EQ(a.size(), b.size());
  ASSERT_FALSE(a.empty());
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(a[i], b[i], 1e-4 * b[i]) << i;
}

// Also with the wrist stretched, where the arm is singular: fails where a posture goes through inverse kinematics
// although nothing is to change.
TEST(Variations, NothingTurnedOrMovedIsThePlainAnswer) {
  const RobotCell cell;
  const std::vector<std::string> base{"--step", "45", "--posture", "home", "--posture", "5,2,12,0,0,3", "--csv", "-"};
  const auto plain = rows_of(cell.varied(base));
  ASSERT_EQ(plain.size(), 16U);
  for (const std::vector<std::string>& asked :
       {std::vector<std::string>{"--redundancy", "0:0:1"}, {"--placement", "0:0:1,0:0:1"}}) {
    std::vector<std::string> arguments = base;
    arguments.insert(arguments.end(), asked.begin(), asked.end());
    arguments.insert(arguments.end(), {"--robot", "robot.urdf"});
    auto rows = rows_of(cell.varied(arguments));
    ASSERT_EQ(rows.size(), plain.size());
    for (std::size_t i = 0; i < rows.size(); ++i) {
      EXPECT_EQ(std::vector<std::string>(rows[i].begin() + 5, rows[i].end()),
                (std::vector<std::string>{"0", "0", "0", plain[i][0] == "home" ? "0" : "1"}));
      rows[i].resize(5);
      EXPECT_EQ(rows[i], plain[i]);
    }
  }
}

TEST(Variations, ColumnsComeAfterThePinnedOnesAndOnlyWhenAsked) {
  const RobotCell cell;
  const std::string pinned = "posture,feed_direction_deg,a_abs_mm,a_pocket_mm,pocket_rpm";
  const auto header = [](const Finished& done) { return done.out.substr(0, done.out.find('\n')); };
  EXPECT_EQ(header(cell.varied({"--step", "180", "--posture", "home", "--csv", "-"})), pinned);
  const Finished turned = cell.varied(
      {"--step", "180", "--posture", "home", "--redundancy", "0:20:2", "--robot", "robot.urdf", "--csv", "-"});
  EXPECT_EQ(header(turned), pinned + ",redundancy_deg,placement_x_mm,placement_y_mm,outside_map");
}

// The map holds what the description gives at places and turns of its own: from `home` the robot must get there. Fails
// with the turn about another axis, the other way round, about another point than the tool's, or a part moved wrongly.
TEST(Variations, TurnAndMoveTheRobotToThePosturesThatTheMapKnows) {
  const RobotCell cell;
  const auto varied = rows_of(cell.varied({"--step", "30", "--posture", "home", "--redundancy", "-20:40:4",
                                           "--placement", "-250:0:2,0:400:2", "--robot", "robot.urdf", "--csv", "-"}));
  struct Known {
    const char *posture, *redundancy, *x, *y;
  };
  for (const Known& known : {Known{"home-20", "-20", "0", "0"},
                             {"home+40", "40", "0", "0"},
                             {"near-centre", "0", "-250", "0"},
                             {"middle-left+20", "20", "0", "400"},
                             {"near-left-20", "-20", "-250", "400"}}) {
    const auto plain = rows_of(cell.varied({"--step", "30", "--posture", known.posture, "--csv", "-"}));
    SCOPED_TRACE(known.posture);
    expect_near(limits_of(varied,
                          [&](const auto& row) {
                            return row[5] == known.redundancy && row[6] == known.x && row[7] == known.y;
                          }),
                limits_of(plain, [](const auto&) { return true; }));
  }
}

TEST(Variations, MapWithoutJointsMovesThePlace) {
  const RobotCell cell;
  cell.forget_joints();
  const auto varied = rows_of(
      cell.varied({"--step", "45", "--posture", "a", "--placement", "0:300:4,0:0:1", "--csv", "-"}, "cell.toml"));
  const auto plain = rows_of(cell.varied({"--step", "45", "--csv", "-"}, "cell.toml"));
  expect_near(limits_of(varied, [](const auto& row) { return row[6] == "100"; }),
              limits_of(plain, [](const auto& row) { return row[0] == "b"; }));
  for (const auto& row : varied) EXPECT_EQ(row[8], row[6] == "300" ? "1" : "0") << row[6];
}

TEST(Variations, GiveTheSameBytesOnAnyNumberOfThreads) {
  const RobotCell cell;
  std::vector<std::string> arguments{
      "--step",       "90",       "--posture", "home",       "--posture",   "far-left",
      "--redundancy", "-60:60:5", "--robot",   "robot.urdf", "--placement", "0:900:3,0:0:1",
      "--json",       "--jobs",   "1"};
  const Finished one = cell.varied(arguments);
  arguments.back() = "3";
  const Finished three = cell.varied(arguments);
  ASSERT_EQ(one.exit_code, 0) << one.err;
  EXPECT_EQ(one.out, three.out);
  EXPECT_EQ(one.err, three.err);
  EXPECT_THAT(one.err, HasSubstr("combinations are left out; the first: "));
}

TEST(Variations, JsonNamesTheBestThatLieInsideTheMap) {
  const RobotCell cell;
  const Finished done = cell.varied({"--step", "30", "--posture", "home", "--posture", "near-centre", "--redundancy",
                                     "-80:40:7", "--robot", "robot.urdf", "--placement", "0:100:2,0:0:1", "--json"});
  ASSERT_EQ(done.exit_code, 0) << done.err;
  const auto json = nlohmann::json::parse(done.out);
  double best = 0.0, best_worst = 0.0;
  bool some_outside = false;
  std::vector<std::vector<double>> at(2, std::vector<double>(2, 0.0));  // placement, posture
  for (const auto& entry : json["postures"]) {
    double high = 0.0, low = 1e9;
    for (const auto& direction : entry["directions"]) {
      high = std::max(high, direction["a_abs_mm"].get<double>());
      low = std::min(low, direction["a_abs_mm"].get<double>());
    }
    some_outside = some_outside || entry["outside_map"];
    if (entry["outside_map"]) continue;
    best = std::max(best, high);
    best_worst = std::max(best_worst, low);
    double& known = at[entry["placement_x_mm"] == 0.0 ? 0 : 1][entry["posture"] == "home" ? 0 : 1];
    known = std::max(known, high);
  }
  EXPECT_TRUE(some_outside);
  EXPECT_EQ(json["best"]["a_abs_mm"], best);
  EXPECT_EQ(json["best_worst_direction"]["a_abs_mm"], best_worst);
  EXPECT_EQ(json["best_placement"]["a_abs_mm"], std::max(std::min(at[0][0], at[0][1]), std::min(at[1][0], at[1][1])));
}

TEST(Variations, SummaryTellsTheBestTurnAndItsGain) {
  const RobotCell cell;
  const Finished done = cell.varied(
      {"--step", "30", "--posture", "home", "--redundancy", "-40:40:5", "--robot", "robot.urdf", "--plot", "turn.svg"});
  ASSERT_EQ(done.exit_code, 0) << done.err;
  EXPECT_THAT(done.out, HasSubstr("home: best redundancy "));
  EXPECT_THAT(done.out, EndsWith(" %)\n"));
  EXPECT_THAT(content_of(cell.path() / "turn.svg"), HasSubstr("<svg"));
  const Finished moved = cell.varied({"--step", "90", "--posture", "home", "--placement", "-100:100:3,-100:100:3",
                                      "--robot", "robot.urdf", "--plot", "placed.svg"});
  EXPECT_THAT(moved.out, HasSubstr("best placement: part moved by "));
  EXPECT_THAT(content_of(cell.path() / "placed.svg"), HasSubstr("<svg"));
}

TEST(Variations, OutsideTheMapIsMarkedAndNeverBest) {
  const RobotCell cell;
  const Finished done = cell.varied(
      {"--step", "90", "--posture", "home", "--redundancy", "80:90:2", "--robot", "robot.urdf", "--csv", "d.csv"});
  ASSERT_EQ(done.exit_code, 0) << done.err;
  EXPECT_EQ(done.out, "home: nothing inside the map\n");
  EXPECT_THAT(done.err,
              HasSubstr("2 of 2 combinations lie outside the map and are not chosen; the first, redundancy 80°"));
}

TEST(Variations, WhereTheRobotCannotStandIsLeftOutAndSaidOnce) {
  const RobotCell cell;
  const std::string narrow = cell.robot_with(
      "lower=\"-6.108652\" upper=\"6.108652\" effort=\"20000\" velocity=\"1.7\"/>\n"
      "    <dynamics damping=\"110\"/>",
      "lower=\"-0.2\" upper=\"0.2\" effort=\"20000\" velocity=\"1.7\"/>\n"
      "    <dynamics damping=\"110\"/>");
  const Finished some =
      cell.varied({"--step", "90", "--posture", "home", "--redundancy", "-40:40:5", "--robot", narrow, "--csv", "-"});
  EXPECT_EQ(rows_of(some).size(), 4U);  // angle 0 in four directions
  EXPECT_THAT(some.err,
              HasSubstr("4 of 5 combinations are left out; the first: home, redundancy -40°, part moved by 0, 0 mm: "
                        "the tool cannot be at 1569.0,0.0,929.0 mm: joint_6 at "));
  const Finished none =
      cell.varied({"--step", "90", "--posture", "home", "--redundancy", "20:40:2", "--robot", narrow, "--csv", "-"});
  EXPECT_EQ(none.exit_code, 3);
  EXPECT_EQ(std::count(none.err.begin(), none.err.end(), '\n'), 1) << none.err;
  EXPECT_THAT(none.err, HasSubstr("joint_6 at"));
}

TEST(Variations, WarnOfAnotherRobotThanTheMaps) {
  const RobotCell cell;
  const std::string longer = cell.robot_with("0.35 0 -0.12", "0.45 0 -0.12");
  const Finished done = cell.varied({"--step", "90", "--posture", "home", "--redundancy", "0:0:1", "--robot", longer});
  EXPECT_EQ(done.exit_code, 0);
  EXPECT_THAT(done.err, HasSubstr("other.urdf: its tool is 100 mm from where the map says at "));
}

TEST(Variations, RefuseWithOneLine) {
  const RobotCell cell, plain;
  plain.forget_joints();
  struct Refusal {
    const RobotCell& cell;
    std::vector<std::string> arguments;
    int exit_code;
    std::string says;
  };
  const Refusal refusals[] = {
      {cell, {"--redundancy", "-30:30"}, 2, "'-30:30' is not MIN:MAX:COUNT"},
      {cell, {"--redundancy", "30:-30:3"}, 2, "MIN must be below MAX"},
      {cell, {"--redundancy", "-30:30:1"}, 2, "MIN must be below MAX"},
      {cell, {"--redundancy", "-200:200:3"}, 2, "more than a whole turn"},
      {cell, {"--placement", "-30:30:3"}, 2, "X_MIN:X_MAX:COUNT,Y_MIN:Y_MAX:COUNT"},
      {cell, {"--placement", "0:1:9999,0:1:9999"}, 2, "more than 100000"},
      {cell, {"--robot", "robot.urdf"}, 2, "--redundancy or --placement"},
      {cell, {"--redundancy", "-30:30:3"}, 3, "give --robot FILE.urdf"},
      {cell, {"--redundancy", "-30:30:3", "--robot", "none.urdf"}, 3, "none.urdf"},
      {plain, {"--redundancy", "-30:30:3"}, 3, "has no joints, so it cannot tell the redundancy angle"},
      {plain, {"--placement", "0:30:3,0:0:1", "--robot", "robot.urdf"}, 3, "leave --robot out"},
  };
  for (const Refusal& refusal : refusals) {
    const Finished done = refusal.cell.varied(refusal.arguments, "cell.toml");
    EXPECT_EQ(done.exit_code, refusal.exit_code) << refusal.says << done.err;
    EXPECT_THAT(done.err, HasSubstr(refusal.says));
    EXPECT_EQ(std::count(done.err.begin(), done.err.end(), '\n'), 1) << done.err;
  }
}

TEST(RobotMapCommand, PlacesMayTurnTheRobotAboutTheTool) {
  const RobotCell cell;
  const Finished done =
      run({"stillcut", "map", "--robot", "robot.urdf", "--postures", "turned-postures.csv", "--out", "m"}, cell.path());
  ASSERT_EQ(done.exit_code, 0) << done.err;
  const DynamicsMap ours = read_dynamics_map(cell.path() / "m"),
                    shipped = read_dynamics_map(cell.path() / "turned-map");
  ASSERT_EQ(ours.postures.size(), shipped.postures.size());
  for (std::size_t p = 0; p < ours.postures.size(); ++p) {
    ASSERT_EQ(ours.postures[p].modes.size(), shipped.postures[p].modes.size());
    for (std::size_t j = 0; j < 6; ++j) EXPECT_NEAR(ours.postures[p].joints[j], shipped.postures[p].joints[j], 1e-7);
  }
  (void)cell.write("both.csv", "posture,j1_deg,j2_deg,j3_deg,j4_deg,j5_deg,j6_deg,redundancy_deg\na,0,1,2,0,70,0,5\n");
  const Finished both =
      run({"stillcut", "map", "--robot", "robot.urdf", "--postures", "both.csv", "--out", "n"}, cell.path());
  EXPECT_EQ(both.exit_code, 3);
  EXPECT_THAT(both.err, HasSubstr("redundancy_deg goes with x_mm,y_mm,z_mm"));
}

}  // namespace
}  // namespace stillcut
