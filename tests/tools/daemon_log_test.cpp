// The daemon on a log played in real time, LCM in the process: what it records is what went in, what it decides is what
// playback decides, and it ends when told. Runs the real programs.
#include <gtest/gtest.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>

#include "drivers/can/candump_log.hpp"
#include "tests/tools/run_program.hpp"

namespace stillcut {
namespace {

// Sound, then deep enough to chatter, then out: two and a half seconds.
void prepare(const DemoCell& cell) {
  cell.simulate("2.5", "0:0,0.2:0,0.3:1.5,0.8:1.5,1.1:3.6,2.1:3.6,2.2:0");
  cell.change("socketcan:can0", "log:cut.log");
  cell.change("[runtime]", "[lcm]\nurl = \"memq://\"\n[runtime]");
}

std::vector<std::string> frames_of(const std::filesystem::path& file) {
  CandumpReader log{file};
  std::vector<std::string> lines;
  std::array<char, kMaxCandumpLine> line{};
  for (CanFrame frame; log.next(frame);) lines.emplace_back(line.data(), format_candump_line(frame, "can", line));
  return lines;
}

TEST(Daemon, RecordsWhatWentInAndDecidesAsPlaybackDoes) {
  const DemoCell cell;
  prepare(cell);
  const Finished done =
      run({"stillcutd", "cell.toml", "--record", "record.log", "--events", "live.csv", "--json"}, cell.path());
  ASSERT_EQ(done.exit_code, 0) << done.err;
  EXPECT_TRUE(frames_of(cell.path() / "cut.log") == frames_of(cell.path() / "record.log"));

  const Finished replayed =
      run({"stillcut", "replay", "cell.toml", "--can", "record.log", "--events", "replay.csv", "--json"}, cell.path());
  ASSERT_EQ(replayed.exit_code, 0) << replayed.err;
  const std::string live = content_of(cell.path() / "live.csv");
  EXPECT_EQ(live, content_of(cell.path() / "replay.csv"));
  EXPECT_NE(live.find(",cut_entry,"), std::string::npos) << live;

  const auto live_summary = nlohmann::json::parse(done.out), replay_summary = nlohmann::json::parse(replayed.out);
  for (const char* key : {"frames", "frames_lost", "frames_bad", "chatter_onsets", "corrections", "faults"}) {
    EXPECT_EQ(live_summary[key], replay_summary[key]) << key;
  }
  for (const char* key : {"record_dropped", "outputs_dropped", "publish_failed", "kernel_dropped"}) {
    EXPECT_EQ(live_summary[key], 0) << key;
  }
  EXPECT_GE(live_summary["published"], 20);  // status ten times a second
}

TEST(Daemon, EndsOnSigtermWithStatusZero) {
  const DemoCell cell;
  prepare(cell);
  Running daemon{{"stillcutd", "cell.toml", "--record", "record.log", "--json"}, cell.path()};
  for (int i = 0; i < 500 && content_of(cell.path() / "record.log").empty(); ++i) {  // it runs once it records
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  daemon.signal(SIGTERM);
  const Finished done = daemon.wait();
  EXPECT_EQ(done.exit_code, 0) << done.err;
  const auto summary = nlohmann::json::parse(done.out);
  EXPECT_GT(summary["frames"], 0);
  EXPECT_EQ(frames_of(cell.path() / "record.log").size(), summary["frames"]);
  EXPECT_NE(done.err.find("SIGTERM received"), std::string::npos) << done.err;
}

TEST(Daemon, EndsAfterTheDurationAsked) {
  const DemoCell cell;
  prepare(cell);
  const Finished done = run({"stillcutd", "cell.toml", "--duration", "0.3", "--json"}, cell.path());
  EXPECT_EQ(done.exit_code, 0) << done.err;
  EXPECT_LT(nlohmann::json::parse(done.out)["frames"], frames_of(cell.path() / "cut.log").size());
}

}  // namespace
}  // namespace stillcut
