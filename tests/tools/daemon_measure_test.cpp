// The daemon while the machine is measured: it runs before there is a map, and asks for nothing. Runs the real programs.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/tools/run_program.hpp"

namespace stillcut {
namespace {

using testing::HasSubstr;

TEST(MeasuringDaemon, RunsWithoutAMapAndCorrectsNothing) {
  const DemoCell cell;
  cell.simulate("1.2", "0:0,0.1:0,0.2:3.6,1:3.6,1.1:0");
  std::filesystem::remove_all(cell.path() / "map");
  cell.change("socketcan:can0", "log:cut.log");
  cell.change("[runtime]", "[lcm]\nurl = \"memq://\"\n[runtime]");
  const Finished shadow = run({"stillcutd", "cell.toml", "--json"}, cell.path());
  EXPECT_EQ(shadow.exit_code, 3);
  EXPECT_THAT(shadow.err, HasSubstr("dynamics.map: no folder"));
  cell.change("mode = \"shadow\"", "mode = \"measure\"");
  const Finished done = run({"stillcutd", "cell.toml", "--record", "record.log", "--json"}, cell.path());
  ASSERT_EQ(done.exit_code, 0) << done.err;
  const auto summary = nlohmann::json::parse(done.out);
  EXPECT_GT(summary["frames"], 3000);
  EXPECT_EQ(summary["corrections"], 0);
  EXPECT_GE(summary["published"], 8);  // status ten times a second
  EXPECT_THAT(done.err, HasSubstr("mode measure"));
  EXPECT_GT(content_of(cell.path() / "record.log").size(), 100'000U);
}

}  // namespace
}  // namespace stillcut
