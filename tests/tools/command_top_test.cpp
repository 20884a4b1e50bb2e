// stillcut top, echo and hz without a terminal and without a network: memq:// is LCM within one process, where nobody
// else speaks. With both: tests/system/terminal.py.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "drivers/lcm/lcm_log.hpp"
#include "tests/drivers/lcm/random_messages.hpp"
#include "tests/tools/run_program.hpp"

namespace stillcut {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

const std::string kDemoCell = EXAMPLES "/demo-cell/cell.toml";

TEST(TopCommand, WithoutADaemonASnapshotEndsWithFourAndSaysHowToStartIt) {
  const TempFolder folder;
  const Finished none = run({"stillcut", "top", kDemoCell, "--once", "--lcm", "memq://"}, folder.path());
  EXPECT_EQ(none.exit_code, 4);
  EXPECT_EQ(none.out, "");
  EXPECT_THAT(none.err,
              StartsWith("stillcut: no daemon was heard at memq:// for 3 s; start it: stillcutd " + kDemoCell));
}

TEST(TopCommand, WrongUseAndInputAreTold) {
  const TempFolder folder;
  EXPECT_EQ(run({"stillcut", "top"}, folder.path()).exit_code, 2);
  EXPECT_EQ(run({"stillcut", "top", "none.toml"}, folder.path()).exit_code, 3);
  EXPECT_EQ(run({"stillcut", "echo"}, folder.path()).exit_code, 2);
  EXPECT_EQ(run({"stillcut", "echo", "[", "--lcm", "memq://"}, folder.path()).exit_code, 2);
  EXPECT_EQ(run({"stillcut", "echo", "A", "--lcm", "none.toml"}, folder.path()).exit_code, 3);
  EXPECT_EQ(run({"stillcut", "hz", "a)b", "--lcm", "memq://"}, folder.path()).exit_code, 2);
  EXPECT_EQ(run({"stillcut", "hz", "--duration", "-1"}, folder.path()).exit_code, 2);
  const Finished nowhere = run({"stillcut", "hz", "--duration", "1", "--lcm", "udpm://nonsense"}, folder.path());
  EXPECT_EQ(nowhere.exit_code, 4);
  EXPECT_THAT(nowhere.err, HasSubstr("udpm://nonsense"));
}

TEST(EchoCommand, ListsEveryChannelWithWhatItCarries) {
  const TempFolder folder;
  const Finished list = run({"stillcut", "echo", "--list"}, folder.path());
  EXPECT_EQ(list.exit_code, 0);
  EXPECT_THAT(list.out, HasSubstr("STILLCUT_MONITOR      monitor_t         What the monitor thinks just now"));
  EXPECT_THAT(list.out, HasSubstr("only in recordings. "));
  const auto json = nlohmann::json::parse(run({"stillcut", "echo", "--list", "--json"}, folder.path()).out);
  ASSERT_GE(json.at("channels").size(), 16U);
  for (const auto& channel : json.at("channels")) EXPECT_FALSE(channel.at("carries").get<std::string>().empty());
}

TEST(EchoCommand, ReadsRecordingsToTheirEnd) {
  const TempFolder folder;
  RandomMessages random{9};
  std::string log;
  for (int i = 0; i < 20; ++i)
    append_lcm_event(log, i, 1'700'000'000'000'000'000 + i * 1'000'000, "STILLCUT_EVENT", encode(random.event()));
  std::ofstream{folder.path() / "events.lcm", std::ios::binary} << log;
  const std::string url = "file://" + (folder.path() / "events.lcm").string() + "?speed=0";
  const Finished done = run({"stillcut", "echo", ".*", "--lcm", url, "--json"}, folder.path());
  EXPECT_EQ(done.exit_code, 0) << done.err;
  std::istringstream lines{done.out};
  int count = 0;
  for (std::string line; std::getline(lines, line); ++count)
    EXPECT_EQ(nlohmann::json::parse(line).at("type"), "event_t");
  EXPECT_EQ(count, 20);
}

TEST(HzCommand, EndsAfterItsDurationWithOneObject) {
  const TempFolder folder;
  const Finished done = run({"stillcut", "hz", "--duration", "0.1", "--json", "--lcm", "memq://"}, folder.path());
  EXPECT_EQ(done.exit_code, 0) << done.err;
  const auto json = nlohmann::json::parse(done.out);
  EXPECT_EQ(json.at("channels").size(), 0U);
  EXPECT_GE(json.at("duration_s").get<double>(), 0.1);
}

}  // namespace
}  // namespace stillcut
