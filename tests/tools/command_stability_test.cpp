// `stillcut stability` as a user meets it: what it writes, and what it refuses.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "drivers/files/csv.hpp"
#include "models/floquet.hpp"
#include "models/receptance.hpp"
#include "tests/tools/run_program.hpp"
#include "tools/cell_posture.hpp"

namespace stillcut {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

std::vector<std::string> stability(std::initializer_list<std::string> more) {
  std::vector<std::string> arguments{"stillcut", "stability", "cell.toml", "--points", "points.csv"};
  arguments.insert(arguments.end(), more);
  return arguments;
}

// As the command should compute it.
FloquetPoint expected(const DemoCell& folder, double rpm, double depth_mm, double feed_direction,
                      const std::string& posture) {
  const Cell cell = read_cell(folder.path() / "cell.toml", {.dbc = false, .bus = false});
  const PredictedPosture predicted = predicted_posture(cell, read_cell_dynamics(cell), posture);
  return floquet_point(linear_cut(*cell.tool, *cell.material, *cell.cut),
                       modes_in_feed_frame(predicted.posture.modes, feed_direction), rpm_to_rad_s(rpm),
                       depth_mm * 1e-3);
}

TEST(StabilityCommand, CsvIsAsPinnedRowForRow) {
  const DemoCell cell;
  (void)cell.write("points.csv", "axial_depth_mm,note,spindle_speed_rpm\n3.6,mine,8500\n0,,12000.5\n0.5,,6000\n");
  for (const std::string posture : {"home", "10,-85,88,0,85,10"}) {
    const Finished done = run(stability({"--csv", "-", "--feed-direction", "-30", "--posture", posture}), cell.path());
    ASSERT_EQ(done.exit_code, 0) << done.err;
    EXPECT_THAT(done.out, StartsWith("spindle_speed_rpm,axial_depth_mm,spectral_radius,chatter_frequency_hz,period_s\n"
                                     "8500,3.6,"));
    EXPECT_THAT(done.out, HasSubstr("\n12000.5,0,"));
    const CsvTable table = parse_csv(done.out, "stdout");
    ASSERT_EQ(table.rows().size(), 3u);
    for (const CsvRow& row : table.rows()) {
      const FloquetPoint point = expected(cell, table.number(row, 0), table.number(row, 1), deg_to_rad(-30), posture);
      EXPECT_NEAR(table.number(row, 2), point.spectral_radius, 1e-12);
      EXPECT_NEAR(table.number(row, 3), point.chatter_frequency / kTwoPi, 1e-9);
      EXPECT_NEAR(table.number(row, 4), 60.0 / (2 * table.number(row, 0)), 1e-15);
    }
  }
}

TEST(StabilityCommand, SaysStableNearAndUnstable) {
  const DemoCell cell;
  const Finished lobes = run({"stillcut", "lobes", "cell.toml", "--speed", "8500:8500:1", "--csv", "-"}, cell.path());
  ASSERT_EQ(lobes.exit_code, 0) << lobes.err;
  const CsvTable table = parse_csv(lobes.out, "stdout");
  const std::string limit = table.text(table.rows()[0], 1);
  (void)cell.write("points.csv", "spindle_speed_rpm,axial_depth_mm\n8500,1\n8500," + limit + "\n8500,10\n");

  const Finished json = run(stability({"--json"}), cell.path());
  ASSERT_EQ(json.exit_code, 0) << json.err;
  const auto points = nlohmann::json::parse(json.out)["points"];
  ASSERT_EQ(points.size(), 3u);
  EXPECT_EQ(points[0]["verdict"], "stable");
  EXPECT_EQ(points[1]["verdict"], "near the limit");
  EXPECT_EQ(points[2]["verdict"], "unstable");
  EXPECT_NEAR(points[1]["spectral_radius"].get<double>(), 1.0, 1e-4);
  EXPECT_NEAR(points[1]["chatter_frequency_hz"].get<double>(), table.number(table.rows()[0], 2), 0.1);
  EXPECT_EQ(points[1]["instability"], "hopf");

  const Finished people = run(stability({}), cell.path());
  EXPECT_EQ(people.exit_code, 0);
  for (const char* word : {" stable ", " near the limit ", " unstable ", "rpm", "mm", "Hz", "hopf", "home"}) {
    EXPECT_THAT(people.out, HasSubstr(word));
  }
}

struct BadPoints {
  const char* name;
  std::string text;
  const char *line_starts, *line_names;
};
void PrintTo(const BadPoints& bad, std::ostream* out) { *out << bad.name; }
class StabilityRefuses : public ::testing::TestWithParam<BadPoints> {};

TEST_P(StabilityRefuses, WithOneLineThatNamesThePlace) {
  const BadPoints& bad = GetParam();
  const DemoCell cell;
  (void)cell.write("points.csv", bad.text);
  const Finished done = run(stability({"--csv", "-"}), cell.path());
  EXPECT_EQ(done.exit_code, 3) << done.err;
  EXPECT_EQ(done.out, "");
  EXPECT_THAT(done.err, StartsWith(std::string("stillcut: ") + bad.line_starts));
  EXPECT_THAT(done.err, HasSubstr(bad.line_names));
  EXPECT_EQ(std::count(done.err.begin(), done.err.end(), '\n'), 1) << done.err;
}

const std::string kHeader = "spindle_speed_rpm,axial_depth_mm\n";

INSTANTIATE_TEST_SUITE_P(
    Points, StabilityRefuses,
    ::testing::Values(
        BadPoints{"speed_zero", kHeader + "8500,1\n0,1\n", "points.csv:3: spindle_speed_rpm: ", "above 0"},
        BadPoints{"speed_negative", kHeader + "-8500,1\n", "points.csv:2: spindle_speed_rpm: ", "above 0"},
        BadPoints{"speed_too_low", kHeader + "0.01,1\n", "points.csv:2: spindle_speed_rpm", "raise the speed"},
        BadPoints{"depth_negative", kHeader + "8500,-0.1\n", "points.csv:2: axial_depth_mm: ", "from 0"},
        BadPoints{"no_number", kHeader + "8500,deep\n", "points.csv:2: axial_depth_mm: ", "deep"},
        BadPoints{"infinite", kHeader + "inf,1\n", "points.csv:2: spindle_speed_rpm: ", "inf"},
        BadPoints{"not_there", kHeader + "8500,\n", "points.csv:2: axial_depth_mm: ", "number"},
        BadPoints{"no_column", "spindle_speed_rpm\n8500\n", "points.csv:1: axial_depth_mm: ", "add it"},
        BadPoints{"misspelt", "spindle_sped_rpm,axial_depth_mm\n8500,1\n",
                  "points.csv:1: spindle_sped_rpm: ", "did you mean spindle_speed_rpm"},
        BadPoints{"twice", "spindle_speed_rpm,axial_depth_mm,axial_depth_mm\n8500,1,1\n",
                  "points.csv:1: axial_depth_mm: ", "twice"},
        BadPoints{"too_many_fields", kHeader + "8500,1,2\n", "points.csv:2: ", "3 fields"},
        BadPoints{"too_few_fields", kHeader + "8500\n", "points.csv:2: ", "1 fields"},
        BadPoints{"open_quote", kHeader + "8500,\"1\n", "points.csv:2: ", "quote"},
        BadPoints{"quote_within", kHeader + "85\"00,1\n", "points.csv:2: ", "quote"},
        BadPoints{"empty", "", "points.csv: ", "empty"},
        BadPoints{"header_only", kHeader, "points.csv:1: ", "add a row"}),
    [](const auto& test) { return std::string(test.param.name); });

TEST(StabilityCommand, RefusesBadCellsPosturesAndUsage) {
  const DemoCell cell;
  (void)cell.write("points.csv", kHeader + "8500,1\n");
  const auto refused = [&](std::initializer_list<std::string> more, int code, const std::string& names) {
    const Finished done = run(stability(more), cell.path());
    EXPECT_EQ(done.exit_code, code) << done.err;
    EXPECT_EQ(done.out, "");
    EXPECT_THAT(done.err, HasSubstr(names));
  };
  refused({"--posture", "away"}, 3, "cell.toml: --posture: posture \"away\": not in the map");
  refused({"--csv", "none/x.csv"}, 3, "none/x.csv: cannot be written");
  refused({"--csv", "/dev/full"}, 3, "/dev/full: cannot be written to the end");
  refused({"--plot", "picture.pdf"}, 3, "picture.pdf: ");
  refused({"--json", "--csv", "-"}, 2, "--json");
  refused({"--feed-direction", "east"}, 2, "--feed-direction");
  cell.change("shape = \"end\"", "shape = \"ball\"");
  const Finished ball = run(stability({"--csv", "-"}), cell.path());  // ball ends are covered
  EXPECT_EQ(ball.exit_code, 0) << ball.err;
  EXPECT_THAT(ball.out, HasSubstr("8500,1,"));
  const Finished missing = run({"stillcut", "stability", "cell.toml"}, cell.path());
  EXPECT_EQ(missing.exit_code, 2);
  EXPECT_THAT(missing.err, HasSubstr("--points"));
  EXPECT_EQ(run({"stillcut", "stability", "cell.toml", "--points", "none.csv"}, cell.path()).exit_code, 3);
}

}  // namespace
}  // namespace stillcut
