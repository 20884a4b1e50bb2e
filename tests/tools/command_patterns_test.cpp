// `stillcut patterns` as a user meets it: what it writes, that it agrees with `stillcut directions`, and what it
// refuses.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "drivers/files/csv.hpp"
#include "drivers/files/feed_map_file.hpp"
#include "drivers/files/tool_path_file.hpp"
#include "models/machining.hpp"
#include "tests/tools/pocket_cell.hpp"
#include "tests/tools/run_program.hpp"

namespace stillcut {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

Finished patterns(const PocketCell& cell, std::initializer_list<std::string> more) {
  std::vector<std::string> arguments{"stillcut", "patterns", "cell.toml", "--method", "zoa", "--step", "30"};
  arguments.insert(arguments.end(), more);
  return run(arguments, cell.path());
}

json answer(const PocketCell& cell, std::initializer_list<std::string> more = {}) {
  std::vector<std::string> arguments{"stillcut", "patterns", "cell.toml", "--method", "zoa", "--step", "30", "--json"};
  arguments.insert(arguments.end(), more);
  const Finished done = run(arguments, cell.path());
  EXPECT_EQ(done.exit_code, 0) << done.err;
  return json::parse(done.out);
}

const json& named(const json& result, const std::string& name) {
  const auto found = std::find_if(result["patterns"].begin(), result["patterns"].end(),
                                  [&](const json& pattern) { return pattern["name"] == name; });
  EXPECT_NE(found, result["patterns"].end()) << name;
  return *found;
}

TEST(PatternsCommand, JsonIsAsPinnedBestIndexFirst) {
  const json result = answer(PocketCell());
  std::set<std::string> names;
  double before = 100.0 + 1e-9;
  for (const json& pattern : result["patterns"]) {
    names.insert(pattern["name"]);
    EXPECT_LE(pattern["asi_percent"], before);
    before = pattern["asi_percent"];
    for (const char* key : {"min_a_abs_mm", "max_a_abs_mm", "pocket_rpm", "a_pocket_mm"})
      EXPECT_TRUE(pattern[key].is_number()) << key;
    EXPECT_LE(pattern["min_a_abs_mm"], pattern["max_a_abs_mm"]);
    EXPECT_LE(pattern["min_a_abs_mm"], pattern["a_pocket_mm"]);
    EXPECT_GE(pattern["pocket_rpm"], 2800);
    EXPECT_LE(pattern["pocket_rpm"], 3800);
  }
  std::set<std::string> wanted{"periphery in", "periphery out", "spiral in", "spiral out"};
  for (int angle = 0; angle < 180; angle += 30) {
    wanted.insert("zig " + std::to_string(angle));
    wanted.insert("zig-zag " + std::to_string(angle));
  }
  EXPECT_EQ(names, wanted);
}

// The contract's words: the mean, in per cent, of a_abs along the pattern over a_abs of the best direction there.
TEST(PatternsCommand, IndexAndLimitsOfZigAreThoseOfTheDirections) {
  const PocketCell cell;
  const Finished done =
      run({"stillcut", "directions", "cell.toml", "--method", "zoa", "--step", "30", "--csv", "-"}, cell.path());
  ASSERT_EQ(done.exit_code, 0) << done.err;
  const CsvTable table = parse_csv(done.out, "stdout");
  std::map<std::string, double> best;
  std::map<std::string, std::map<std::string, double>> limits;  // by direction, by posture
  for (const CsvRow& row : table.rows()) {
    const double limit = std::stod(row.fields[2]);
    best[row.fields[0]] = std::max(best[row.fields[0]], limit);
    limits[row.fields[1]][row.fields[0]] = limit;
  }
  const json result = answer(cell);
  for (const std::string angle : {"0", "30", "90", "150"}) {
    double sum = 0.0, lowest = 1e9, highest = 0.0;
    for (const auto& [posture, limit] : limits[angle]) {
      sum += limit / best[posture];
      lowest = std::min(lowest, limit);
      highest = std::max(highest, limit);
    }
    const json& zig = named(result, "zig " + angle);
    EXPECT_NEAR(zig["asi_percent"], 100.0 * sum / 9.0, 1e-4) << angle;
    EXPECT_NEAR(zig["min_a_abs_mm"], lowest, 1e-5) << angle;
    EXPECT_NEAR(zig["max_a_abs_mm"], highest, 1e-5) << angle;
    EXPECT_LE(named(result, "zig-zag " + angle)["asi_percent"], zig["asi_percent"]);
  }
}

TEST(PatternsCommand, TheOptimizedPathIsNeverWorseThanTheBestPattern) {
  const PocketCell cell;
  const json by_index = answer(cell, {"--turning-cost", "1"});
  const json& optimized = by_index["optimized"];
  EXPECT_GE(optimized["asi_percent"], by_index["patterns"][0]["asi_percent"]);
  EXPECT_GT(optimized["patches"].size(), 1U) << "here the best direction turns along X";
  const json by_time = answer(cell, {"--objective", "time", "--turning-cost", "1"});
  double fastest = 1e9;
  for (const json& pattern : by_time["patterns"]) fastest = std::min(fastest, pattern["time_s_per_mm"].get<double>());
  EXPECT_LE(by_time["optimized"]["time_s_per_mm"], fastest);
  const json dear = answer(cell, {"--turning-cost", "100"});
  EXPECT_LE(dear["optimized"]["patches"].size(), 1U);
}

TEST(PatternsCommand, TheProgramCutsWhatThePlanSaysAtItsSpeedsAndDepth) {
  const PocketCell cell;
  const Finished done = patterns(cell, {"--turning-cost", "1", "--gcode", "pocket.nc", "--depth", "3", "--json"});
  ASSERT_EQ(done.exit_code, 0) << done.err;
  const json optimized = json::parse(done.out)["optimized"];
  std::set<std::pair<int, int>> wanted, found;  // direction and speed
  for (const json& patch : optimized["patches"]) {
    wanted.emplace(std::lround(patch["feed_direction_deg"].get<double>()),
                   std::lround(patch["spindle_speed_rpm"].get<double>()));
  }
  std::set<long> depths;
  for (const PathMove& move : read_tool_path(cell.path() / "pocket.nc").moves) {
    if (!move.cutting) continue;
    const Eigen::Vector3d way = move.to - move.from;
    if (way.norm() < 2e-3) continue;  // short lines have the direction of their rounding
    const double degrees = rad_to_deg(std::atan2(way.y(), way.x()));
    found.emplace(std::lround(degrees + 360.0) % 180, std::lround(rad_s_to_rpm(move.spindle_speed)));
    EXPECT_NEAR(move.feed_rate, 2 * 0.1e-3 * move.spindle_speed / kTwoPi, 1e-5);
    depths.insert(std::lround(-1e7 * move.to.z()));
  }
  EXPECT_EQ(found, wanted);
  EXPECT_EQ(*depths.rbegin(), 30000);
  EXPECT_LE(3.0 / static_cast<double>(depths.size()), optimized["axial_depth_mm"].get<double>() + 1e-9);
}

TEST(PatternsCommand, APathFromAFileIsRatedAsThePatternItIs) {
  const PocketCell cell;
  ASSERT_EQ(patterns(cell, {"--pattern", "zig 60", "--gcode", "sixty.nc"}).exit_code, 0);
  const json result = answer(cell, {"--path", "sixty.nc"});
  EXPECT_NEAR(named(result, "sixty")["asi_percent"], named(result, "zig 60")["asi_percent"], 1e-4);
  EXPECT_NEAR(named(result, "sixty")["a_pocket_mm"], named(result, "zig 60")["a_pocket_mm"], 1e-5);
  const PocketCell without_region("");
  std::filesystem::copy_file(cell.path() / "sixty.nc", without_region.path() / "sixty.nc");
  const json alone = answer(without_region, {"--path", "sixty.nc"});
  EXPECT_EQ(alone["patterns"].size(), 1U);
  EXPECT_FALSE(alone.contains("optimized"));
}

// A file is a program with heights of its own, and need not fill the region.
TEST(PatternsCommand, APathFromAFileIsNeitherWrittenAgainNorTakenForTheOptimum) {
  const PocketCell cell;
  std::ofstream{cell.path() / "line.nc"} << "G21 G90\nM3 S3000\nG0 X20 Y50 Z5\nG1 Z-3 F100\nX80\n";
  const json result = answer(cell, {"--objective", "time", "--path", "line.nc"});
  EXPECT_LT(named(result, "line")["time_s_per_mm"], result["optimized"]["time_s_per_mm"]);
  EXPECT_NE(result["optimized"]["made_of"], "line");
  std::ofstream{cell.path() / "kept.nc"} << "a program\n";
  const Finished refused = patterns(cell, {"--path", "line.nc", "--pattern", "line", "--gcode", "kept.nc"});
  EXPECT_EQ(refused.exit_code, 3);
  EXPECT_THAT(refused.err, HasSubstr("line.nc: is a program already"));
  EXPECT_EQ(patterns(cell, {"--pattern", "zig 7", "--gcode", "kept.nc"}).exit_code, 2);
  EXPECT_EQ(content_of(cell.path() / "kept.nc"), "a program\n") << "an error leaves what was there";
}

// Of postures that do not stand in columns and rows a patch holds parts that are nearer to a neighbour's.
TEST(PatternsCommand, ThePlannedDepthIsStableAlongThePathOverScatteredPostures) {
  const PocketCell cell;
  const std::vector<Eigen::Vector2d> places{{20, 0}, {80, 100}};
  std::ofstream{cell.path() / "map" / "postures.csv"} << "posture,x_mm,y_mm,z_mm\n1,20,0,0\n2,80,100,0\n";
  std::ofstream{cell.path() / "map" / "modes.csv"}
      << "posture,mode,frequency_hz,damping_ratio,stiffness_n_per_m,ux,uy,uz\n"
         "1,1,490,0.03,2e6,1,0,0\n1,2,530,0.03,2e7,0,1,0\n2,1,500,0.03,2e6,0,1,0\n2,2,540,0.03,2e7,1,0,0\n";
  std::string text = content_of(cell.path() / "cell.toml");
  text.replace(text.find("posture = \"5\""), 13, "posture = \"1\"");
  std::ofstream{cell.path() / "cell.toml"} << text;
  const Finished done = patterns(cell, {"--turning-cost", "0.1", "--gcode", "plan.nc", "--json"});
  ASSERT_EQ(done.exit_code, 0) << done.err;
  const json optimized = json::parse(done.out)["optimized"];
  ASSERT_GT(optimized["patches"].size(), 1U);
  std::set<std::tuple<std::string, int, int>> cuts;  // posture, direction, speed
  for (const PathMove& move : read_tool_path(cell.path() / "plan.nc").moves) {
    const Eigen::Vector2d way = 1e3 * (move.to - move.from).head<2>();
    if (!move.cutting || way.norm() < 5.0) continue;
    const int direction = static_cast<int>(std::lround(rad_to_deg(std::atan2(way.y(), way.x())) + 360.0) % 180);
    for (const double share : {0.05, 0.5, 0.95}) {
      const Eigen::Vector2d point = 1e3 * move.from.head<2>() + share * way;
      const bool first = (point - places[0]).norm() < (point - places[1]).norm();
      cuts.emplace(first ? "1" : "2", direction, std::lround(rad_s_to_rpm(move.spindle_speed)));
    }
  }
  EXPECT_GT(cuts.size(), 2U) << "a patch has both postures in it";
  for (const auto& [posture, direction, speed] : cuts) {
    const std::string speeds = std::to_string(speed) + ":" + std::to_string(speed + 1) + ":2";
    const Finished lobes = run({"stillcut", "lobes", "cell.toml", "--posture", posture, "--feed-direction",
                                std::to_string(direction), "--method", "zoa", "--speed", speeds, "--csv", "-"},
                               cell.path());
    ASSERT_EQ(lobes.exit_code, 0) << lobes.err;
    const CsvTable points = parse_csv(lobes.out, "stdout");
    EXPECT_LE(optimized["axial_depth_mm"].get<double>(), std::stod(points.rows()[0].fields[1]))
        << posture << ", " << direction << " deg, " << speed << " rpm";
  }
}

TEST(PatternsCommand, PosturesAtOnePlaceAreRefusedUnlessOneIsChosen) {
  const PocketCell cell;
  std::ofstream{cell.path() / "map" / "postures.csv", std::ios::app} << "high,50,50,40\n";
  std::ofstream{cell.path() / "map" / "modes.csv", std::ios::app} << "high,1,490,0.03,2e6,1,0,0\n";
  const Finished refused = patterns(cell, {});
  EXPECT_EQ(refused.exit_code, 3);
  EXPECT_THAT(refused.err, HasSubstr("postures 5 and high have the same x_mm and y_mm"));
  const Finished chosen = patterns(cell, {"--posture", "1", "--posture", "3", "--posture", "high", "--json"});
  ASSERT_EQ(chosen.exit_code, 0) << chosen.err;
  EXPECT_EQ(json::parse(chosen.out)["locations"].size(), 3U);
}

TEST(PatternsCommand, GivesTheSameBytesOnAnyNumberOfThreads) {
  const PocketCell cell;
  EXPECT_EQ(patterns(cell, {"--jobs", "1", "--json"}).out, patterns(cell, {"--jobs", "3", "--json"}).out);
}

TEST(PatternsCommand, WritesAFeedMapThatTheDaemonReads) {
  const PocketCell cell;
  ASSERT_EQ(patterns(cell, {"--turning-cost", "0", "--feed-map", "feed.csv"}).exit_code, 0);
  const FeedMap map = read_feed_map(cell.path() / "feed.csv");
  const json result = answer(cell);
  EXPECT_EQ(map.proposals.size(), 9U);
  for (const json& location : result["locations"]) {
    const double planned =
        planned_direction(map, 1e-3 * location["x_mm"].get<double>(), 1e-3 * location["y_mm"].get<double>());
    EXPECT_NEAR(rad_to_deg(planned), location["best_direction_deg"], 1e-6);
  }
}

TEST(PatternsCommand, AFinerGridHasItsLocationsBetweenThePostures) {
  const json result = answer(PocketCell(), {"--grid", "25"});
  EXPECT_EQ(result["locations"].size(), 25U);
  EXPECT_EQ(result["locations"][1]["x_mm"], 25.0);
}

TEST(PatternsCommand, DirectionsTakesTheSameGrid) {
  const PocketCell cell;
  const Finished done =
      run({"stillcut", "directions", "cell.toml", "--method", "zoa", "--step", "90", "--grid", "25", "--csv", "-"},
          cell.path());
  ASSERT_EQ(done.exit_code, 0) << done.err;
  const CsvTable table = parse_csv(done.out, "stdout");
  EXPECT_EQ(table.rows().size(), 25U * 4U);
  EXPECT_EQ(table.rows()[4].fields[0], "25,0,0");
  std::ofstream{cell.path() / "map" / "postures.csv"} << "posture,x_mm,y_mm,z_mm\n1,0,7,0\n2,50,7,0\n";
  std::ofstream{cell.path() / "map" / "modes.csv"} << "posture,mode,frequency_hz,damping_ratio,stiffness_n_per_m,ux,uy,"
                                                      "uz\n1,1,490,0.03,2e6,1,0,0\n2,1,490,0.03,2e6,1,"
                                                      "0,0\n";
  const Finished line =
      run({"stillcut", "directions", "cell.toml", "--method", "zoa", "--step", "90", "--grid", "25", "--csv", "-"},
          cell.path());
  ASSERT_EQ(line.exit_code, 0) << line.err;
  EXPECT_EQ(parse_csv(line.out, "stdout").rows().size(), 3U * 4U) << "postures in a line give places in a line";
}

TEST(PatternsCommand, MeasuredPlacesMayLieFartherApartOneWayThanTheOther) {
  const PocketCell cell;
  const std::string file = (cell.path() / "map" / "postures.csv").string();
  std::ofstream postures{file};
  postures << "posture,x_mm,y_mm,z_mm\n";
  for (int i = 0; i < 9; ++i)
    postures << i + 1 << ',' << (i < 8 ? 10 * (i % 4) + 35 : 5000) << ',' << 100 * (i / 4) << ",0\n";
  postures.close();
  EXPECT_EQ(patterns(cell, {}).exit_code, 0) << "rows 100 mm apart, and a posture far away";
}

TEST(PatternsCommand, DrawsItsPictures) {
  const PocketCell cell;
  for (const std::string picture : {"ranking", "field", "lobes", "path"}) {
    const Finished done = patterns(cell, {"--picture", picture, "--plot", picture + ".svg"});
    ASSERT_EQ(done.exit_code, 0) << done.err;
    EXPECT_THAT(content_of(cell.path() / (picture + ".svg")), HasSubstr("<svg"));
  }
}

struct Refusal {
  std::string region;
  std::vector<std::string> arguments;
  int exit_code;
  std::string says;
};

class PatternsRefused : public testing::TestWithParam<Refusal> {};

TEST_P(PatternsRefused, InOneLineThatSaysWhatToDo) {
  const auto& [region, more, exit_code, says] = GetParam();
  const PocketCell cell(region);
  std::ofstream{cell.path() / "left.nc"} << "G21 G90\nM3 S3000\nG0 X0 Y0 Z0\nG41 D1\nG1 X50 F100\n";
  std::vector<std::string> arguments{"stillcut", "patterns", "cell.toml", "--method", "zoa", "--step", "30"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  const Finished done = run(arguments, cell.path());
  EXPECT_EQ(done.exit_code, exit_code);
  EXPECT_THAT(done.err, HasSubstr(says));
  if (exit_code == 3) {
    EXPECT_EQ(std::count(done.err.begin(), done.err.end(), '\n'), 1) << done.err;
  }
}

const std::string kSquare = "polygon_mm = [[0, 0], [100, 0], [100, 100], [0, 100]]";

INSTANTIATE_TEST_SUITE_P(
    BadInput, PatternsRefused,
    testing::Values(
        Refusal{"", {}, 3, "[region] is missing"},
        Refusal{"polygon_mm = [[0, 0], [100, 100], [100, 0], [0, 100]]", {}, 3, "cell.toml:25: region.polygon_mm"},
        Refusal{"polygon_mm = [[0, 0], [100, 0]]", {}, 3, "polygon_mm"},
        Refusal{"polygon_mm = [[0, 0], [15, 0], [15, 100], [0, 100]]", {}, 3, "does not fit into the region"},
        Refusal{kSquare + "\nislands_mm = [[[80, 80], [120, 80], [120, 90]]]", {}, 3, "islands_mm"},
        Refusal{"polygon_mm = [[500, 0], [600, 0], [600, 100], [500, 100]]", {}, 3, "from the nearest posture"},
        Refusal{"polygon_mm = [[0, 0], [300, 0], [300, 100], [0, 100]]", {}, 3, "measure there, or say with --reach"},
        Refusal{kSquare, {"--grid", "0.5"}, 3, "gives more than 2500 places"},
        Refusal{kSquare, {"--json", "--gcode", "-"}, 2, "both go to standard output"},
        Refusal{kSquare, {"--gcode", "a.nc", "--feed-map", "a.nc"}, 2, "goes to the same place as --gcode"},
        Refusal{kSquare, {"--depth", "3"}, 2, "add --gcode FILE"},
        Refusal{kSquare, {"--path", "left.nc"}, 3, "left.nc:4: G41"},
        Refusal{kSquare, {"--path", "none.nc"}, 3, "none.nc"},
        Refusal{kSquare, {"--pattern", "zig 45", "--gcode", "a.nc"}, 2, "there is no pattern \"zig 45\""},
        Refusal{kSquare, {"--radial-depth", "21"}, 2, "is more than the tool's diameter"}));

TEST(PatternsCommand, StepsThatDoNotDivideHalfATurnAreRefused) {
  const PocketCell cell;
  const Finished done = run({"stillcut", "patterns", "cell.toml", "--step", "7"}, cell.path());
  EXPECT_EQ(done.exit_code, 2);
  EXPECT_THAT(done.err, HasSubstr("must divide 180 degrees"));
}

}  // namespace
}  // namespace stillcut
