// Recordings on the page's timeline: what it shows at a moment, and recordings that hold next to nothing.
#include "tools/scope_timeline.hpp"

#include <gtest/gtest.h>

#include "tests/tools/run_program.hpp"

namespace stillcut {
namespace {

std::unique_ptr<TimelineFeed> timeline_of(const DemoCell& files, const std::string& log) {
  std::vector<std::string> warnings;
  PlaybackSource source;
  source.can = files.path() / log;
  return timeline_of_recording(read_cell(files.path() / "cell.toml", {.bus = false}), source,
                               {"cell", "recording", log, 2, 0.0, 0.0}, warnings);
}

// The state that a viewer finds who goes there.
nlohmann::json state_at(TimelineFeed& timeline, double time_s) {
  const auto viewer = timeline.open(time_s, 0.1);
  const std::string name = "event: state\ndata: ";
  for (Chunk chunk = viewer->next({}); chunk != nullptr; chunk = viewer->next({}))
    if (chunk->starts_with(name)) return nlohmann::json::parse(chunk->substr(name.size()));
  return nullptr;
}

TEST(ScopeTimeline, InASilenceItShowsThatNothingIsHeardAndNotTheStateBefore) {
  const DemoCell files;
  files.simulate("2", "0:0,0.2:0,0.25:1.5");
  std::istringstream log{content_of(files.path() / "cut.log")};
  std::ofstream with_gap{files.path() / "gap.log"};
  double first_s = 0.0;
  for (std::string line; std::getline(log, line);) {
    const double stamp_s = std::stod(line.substr(1));
    if (first_s == 0.0) first_s = stamp_s;
    const double later_s = stamp_s - first_s < 1.0 ? 0.0 : 60.0;
    with_gap << '(' << std::fixed << stamp_s + later_s << line.substr(line.find(')')) << '\n';
  }
  with_gap.close();
  const auto timeline = timeline_of(files, "gap.log");
  EXPECT_NE(state_at(*timeline, 0.9)["state"], "cannot tell");
  for (const double time_s : {2.0, 30.0, 60.0}) {
    const nlohmann::json state = state_at(*timeline, time_s);
    EXPECT_EQ(state["state"], "cannot tell") << time_s;
    EXPECT_LE(state["t"], time_s);
  }
  EXPECT_NE(state_at(*timeline, 61.9)["state"], "cannot tell");
  const nlohmann::json marks = timeline->about()["marks"];
  EXPECT_FALSE(marks.empty());
  for (const auto& mark : marks) EXPECT_LE(mark["t"], 62.0);
}

TEST(ScopeTimeline, ARecordingWithoutAFrameOfTheCellIsShownAsOneThatSaysNothing) {
  const DemoCell files;
  std::ofstream{files.path() / "other.log"} << "(1700000000.000000) can0 7FF#00\n";
  const auto timeline = timeline_of(files, "other.log");
  EXPECT_EQ(timeline->about()["duration_s"], 0.0);
  EXPECT_EQ(timeline->about()["start_utime"], 1'700'000'000'000'000);
  EXPECT_NE(timeline->metrics().find("stillcut_up"), std::string::npos);
  EXPECT_EQ(state_at(*timeline, 0.0), nullptr);
}

}  // namespace
}  // namespace stillcut
