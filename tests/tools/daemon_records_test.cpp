// The daemon's own recording, as a user makes and plays it; runs the real programs.
#include <gtest/gtest.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <thread>

#include "tests/tools/run_program.hpp"

namespace stillcut {
namespace {

class RecordedCell : public DemoCell {
 public:
  RecordedCell() {
    simulate("2.5", "0:0,0.2:0,0.3:1.5,0.8:1.5,1.1:3.6,2.1:3.6,2.2:0");
    change("socketcan:can0", "log:cut.log");
    change("[runtime]", "[lcm]\nurl = \"memq://\"\n[recording]\nfolder = \"recording\"\nsegment_s = 1\n[runtime]");
  }
};

std::vector<std::string> files_in(const std::filesystem::path& folder, const std::string& ending) {
  std::vector<std::string> names;
  std::error_code none_yet;
  for (const auto& entry : std::filesystem::directory_iterator{folder, none_yet})
    if (entry.path().string().ends_with(ending)) names.push_back(entry.path().string());
  return names;
}

TEST(DaemonRecording, OfTheCellsFolderIsPlayedAgain) {
  const RecordedCell cell;
  const Finished done = run({"stillcutd", "cell.toml", "--events", "live.csv", "--json"}, cell.path());
  ASSERT_EQ(done.exit_code, 0) << done.err;
  const auto live = nlohmann::json::parse(done.out);
  EXPECT_EQ(live["recorded_frames"], live["frames"]);
  EXPECT_EQ(live["record_lost"], 0);
  EXPECT_GE(live["recorded_marks"], 2);  // chatter and its correction
  EXPECT_GE(files_in(cell.path() / "recording", ".can.log.zst").size(), 2U);
  EXPECT_GE(files_in(cell.path() / "recording", ".mark").size(), 1U);

  const Finished again =
      run({"stillcut", "replay", "cell.toml", "--can", "recording", "--events", "again.csv", "--json"}, cell.path());
  ASSERT_EQ(again.exit_code, 0) << again.err;
  EXPECT_EQ(content_of(cell.path() / "live.csv"), content_of(cell.path() / "again.csv"));
  const auto summary = nlohmann::json::parse(again.out);
  EXPECT_EQ(summary["frames"], live["frames"]);
  EXPECT_GT(summary["recorded_outputs"], 4);
  EXPECT_EQ(summary["same_outputs"], summary["recorded_outputs"]);
  EXPECT_EQ(summary["same_outputs"], summary["replayed_outputs"]);
  EXPECT_EQ(again.err, "");
  for (const char* end_s : {"0.3", "1", "2", "100"}) {
    const Finished part =
        run({"stillcut", "export", "cell.toml", "--can", "recording", "--mcap", "part.mcap", "--to", end_s, "--json"},
            cell.path());
    ASSERT_EQ(part.exit_code, 0) << part.err;
    EXPECT_EQ(part.err, "") << end_s;
  }
}

// Played with another cell file it is decided otherwise, and that is said.
TEST(DaemonRecording, OfAnotherCellIsToldApart) {
  const RecordedCell cell;
  ASSERT_EQ(run({"stillcutd", "cell.toml"}, cell.path()).exit_code, 0);
  cell.change("mode = \"shadow\"", "mode = \"off\"");
  for (const std::vector<std::string>& command : std::vector<std::vector<std::string>>{
           {"replay"}, {"report"}, {"export", "--mcap", "all.mcap"}, {"export", "--events", "some.csv", "--to", "2"}}) {
    std::vector<std::string> arguments{"stillcut", command[0], "cell.toml", "--can", "recording", "--json"};
    arguments.insert(arguments.end(), command.begin() + 1, command.end());
    const Finished again = run(arguments, cell.path());
    ASSERT_EQ(again.exit_code, 0) << again.err;
    EXPECT_NE(again.err.find("is this the cell file of that run?"), std::string::npos) << command[0] << again.err;
  }
}

TEST(DaemonRecording, IsMarkedByTheOperatorsSignal) {
  const RecordedCell cell;
  Running daemon{{"stillcutd", "cell.toml", "--record", "by-hand", "--json"}, cell.path()};
  for (int i = 0; i < 500 && files_in(cell.path() / "by-hand", ".can.log.zst").empty(); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  daemon.signal(SIGUSR1);
  const Finished done = daemon.wait();
  ASSERT_EQ(done.exit_code, 0) << done.err;
  const auto marks = files_in(cell.path() / "by-hand", ".mark");
  ASSERT_FALSE(marks.empty());
  EXPECT_EQ(content_of(*std::min_element(marks.begin(), marks.end())), "operator\n");
  EXPECT_TRUE(files_in(cell.path() / "recording", ".zst").empty());  // the option takes the place of the cell's folder
}

TEST(DaemonRecording, RefusesAFolderThatCannotBeMade) {
  const RecordedCell cell;
  const Finished done = run({"stillcutd", "cell.toml", "--record", "cell.toml/recording"}, cell.path());
  EXPECT_EQ(done.exit_code, 3);
  EXPECT_NE(done.err.find("cell.toml/recording: "), std::string::npos) << done.err;
}

}  // namespace
}  // namespace stillcut
