// `stillcut trajectory` as a user meets it: what it writes, and what it refuses.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "drivers/files/csv.hpp"
#include "tests/tools/run_program.hpp"

namespace stillcut {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

Finished trajectory(const TempFolder& folder, const std::string& cases, const std::vector<std::string>& more) {
  (void)folder.write("moves.csv", cases);
  std::vector<std::string> arguments{"stillcut", "trajectory", "--batch", "moves.csv"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return run(arguments, folder.path());
}

TEST(TrajectoryCommand, CsvIsAsPinnedRowForRow) {
  const TempFolder folder;
  const std::string position =
      "jmax,note,p0,v0,a0,pf,vf,af,vmax,amax\n4,mine,0,0,0,75,0,0,10,2\n0.5,,2,0,0,1,0,0,10,2\n";
  const std::string velocity = "v0,a0,vf,af,amax,jmax,vmax\n0,0,10,0,2,4,ignored\n";
  for (const auto& more : {std::vector<std::string>{"--csv", "-"}, std::vector<std::string>{"--csv"}}) {
    const Finished done = trajectory(folder, position, more);
    ASSERT_EQ(done.exit_code, 0) << done.err;
    EXPECT_THAT(done.out, StartsWith("duration_s,calc_ns\n13,"));
    const CsvTable table = parse_csv(done.out, "stdout");
    ASSERT_EQ(table.rows().size(), 2u);
    EXPECT_NEAR(table.number(table.rows()[1], 0), 4.0, 1e-15);
    EXPECT_GT(table.number(table.rows()[0], 1), 0.0);
  }
  const Finished done = trajectory(folder, velocity, {"--csv", "out.csv"});
  ASSERT_EQ(done.exit_code, 0) << done.err;
  EXPECT_THAT(content_of(folder.path() / "out.csv"), StartsWith("duration_s,calc_ns\n5.5,"));
}

TEST(TrajectoryCommand, MatchesTheReferenceTables) {
  const TempFolder folder;
  for (const std::string name : {"position.csv", "velocity.csv"}) {
    const CsvTable reference = read_csv(std::string(TEST_DATA "/trajectory/") + name);
    const Finished done = trajectory(folder, content_of(std::string(TEST_DATA "/trajectory/") + name), {"--csv", "-"});
    ASSERT_EQ(done.exit_code, 0) << done.err;
    EXPECT_EQ(done.err, "");
    const CsvTable found = parse_csv(done.out, "stdout");
    ASSERT_EQ(found.rows().size(), reference.rows().size());
    for (std::size_t i = 0; i < found.rows().size(); ++i) {
      const CsvRow& row = reference.rows()[i];
      const double wanted = reference.number(row, reference.require_column("duration"));
      EXPECT_LE(found.number(found.rows()[i], 0), wanted * (1 + 1e-9)) << name << ":" << row.line;
    }
  }
}

TEST(TrajectoryCommand, SaysWhyACaseIsImpossibleAndGoesOn) {
  const TempFolder folder;
  const Finished done = trajectory(folder,
                                   "p0,v0,a0,pf,vf,af,vmax,amax,jmax\n"
                                   "0,0,0,75,0,0,10,2,4\n"
                                   "0,0,0,1,0,9,1,1,1\n"
                                   "0,0,0,1,2,0,1,1,1\n"
                                   "0,inf,0,1,0,0,1,1,1\n"
                                   "0,0,0,1,0,0,1,1,0\n"
                                   "0,0,0,1e300,0,0,1e-300,1,1\n"
                                   "0,0,0,75,0,0,10,2,4\n",
                                   {"--csv", "-"});
  ASSERT_EQ(done.exit_code, 0) << done.err;
  const char* const reasons[] = {
      "stillcut: moves.csv:3: af: ", "\nstillcut: moves.csv:4: vf: ", "\nstillcut: moves.csv:5: v0: ",
      "\nstillcut: moves.csv:6: jmax: ", "\nstillcut: moves.csv:7: pf: "};
  for (const char* reason : reasons) EXPECT_THAT(done.err, HasSubstr(reason));
  EXPECT_EQ(std::count(done.err.begin(), done.err.end(), '\n'), 5) << done.err;
  EXPECT_THAT(done.out, HasSubstr("\nnan,"));
  EXPECT_EQ(std::count(done.out.begin(), done.out.end(), '\n'), 8) << done.out;
  EXPECT_EQ(done.out.rfind("\n13,"), done.out.find_last_of('\n', done.out.size() - 2)) << done.out;
}

TEST(TrajectoryCommand, JsonIsOneObject) {
  const TempFolder folder;
  const Finished done = trajectory(folder, "v0,a0,vf,af,amax,jmax\n0,0,10,0,2,4\n0,0,1,5,2,4\n", {"--json"});
  ASSERT_EQ(done.exit_code, 0) << done.err;
  const auto object = nlohmann::json::parse(done.out);
  EXPECT_EQ(object["interface"], "velocity");
  EXPECT_EQ(object["impossible"], 1);
  EXPECT_EQ(object["cases"][0]["duration_s"], 5.5);
  EXPECT_TRUE(object["cases"][1]["duration_s"].is_null());
}

TEST(TrajectoryCommand, RefusesWhatIsNoTable) {
  const TempFolder folder;
  Finished done = trajectory(folder, "p0,v0,a0,pf,vf,af,vmax,amax\n", {});
  EXPECT_EQ(done.exit_code, 3);
  EXPECT_THAT(done.err, StartsWith("stillcut: moves.csv:1: "));
  EXPECT_THAT(done.err, HasSubstr("jmax"));
  done = trajectory(folder, "v0,a0,vf,af,amax,jmax\n0,0,fast,0,2,4\n", {});
  EXPECT_EQ(done.exit_code, 3);
  EXPECT_THAT(done.err, StartsWith("stillcut: moves.csv:2: "));
  EXPECT_EQ(run({"stillcut", "trajectory"}, folder.path()).exit_code, 2);
  EXPECT_EQ(run({"stillcut", "trajectory", "--batch", "none.csv"}, folder.path()).exit_code, 3);
  const Finished help = run({"stillcut", "trajectory", "--help"}, folder.path());
  EXPECT_EQ(help.exit_code, 0);
  EXPECT_THAT(help.out, HasSubstr("Example"));
}

}  // namespace
}  // namespace stillcut
