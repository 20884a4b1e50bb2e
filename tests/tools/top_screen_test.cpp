#include "tools/top_screen.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "tests/tools/top_scene.hpp"

namespace stillcut {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TopScene scene_at(std::int64_t now_ns = kHeard_ns) {
  TopScene scene;
  scene.title = "demo-cell";
  scene.where = "udpm://239.255.76.67:7667?ttl=0";
  scene.min_rpm = 6000;
  scene.max_rpm = 14000;
  scene.now_ns = now_ns;
  return scene;
}
std::string all_text(const TopScreen& screen) {
  std::string text;
  for (const TextLine& line : screen.lines) text += text_of(line) + "\n";
  return text;
}
// What all pages say together.
std::string every_page(const CellView& view, TopScene scene, int columns, int rows) {
  std::string text;
  int pages = 1;
  for (scene.page = 0; scene.page < pages; ++scene.page) {
    const TopScreen screen = draw_top(view, scene, columns, rows);
    pages = screen.pages;
    text += all_text(screen);
  }
  return text;
}

// States in turn, as the view gives them.
std::vector<CellView> cells_in_every_state() {
  std::vector<CellView> cells(1);  // no daemon
  MonitorReport monitor = monitor_in_chatter();
  const auto add = [&](std::initializer_list<TelemetryMessage> more) {
    cells.emplace_back().take(monitor, kHeard_ns);
    for (const TelemetryMessage& message : more) cells.back().take(message, kHeard_ns);
  };
  add({});
  add({asked_of(CorrectionKind::spindle_speed, kHeard_ns)});
  monitor.doubts = kSaturated | kGap | kStuck | kNotFinite;
  add({});
  monitor.doubts = 0;
  HealthReport health;
  health.bus_state = 2;
  add({health});
  monitor.chatter = false;
  monitor.state = State::air;
  add({});
  monitor.state = State::cut;
  add({});
  monitor.indicator = 0.1;
  monitor.margin = 0.5;
  add({});
  return cells;
}

TEST(TopScreen, FitsEverySizeAndAlwaysShowsTheState) {
  std::set<Shown> seen;
  std::vector<CellView> cells = cells_in_every_state();
  cells.push_back(busy_cell());
  for (const CellView& view : cells) {
    const std::string state = shown_name(view.state(kHeard_ns).shown);
    seen.insert(view.state(kHeard_ns).shown);
    for (const int columns : {1, 5, 11, 20, 37, 79, 80, 120, 157, 160, 240, 400})
      for (const int rows : {1, 2, 3, 6, 10, 15, 16, 24, 50, 120})
        for (const bool help : {false, true}) {
          TopScene scene = scene_at();
          scene.help = help;
          int pages = 1;
          for (scene.page = 0; scene.page < pages; ++scene.page) {
            const TopScreen screen = draw_top(view, scene, columns, rows);
            pages = screen.pages;
            EXPECT_LE(static_cast<int>(screen.lines.size()), rows) << columns << 'x' << rows;
            for (const TextLine& line : screen.lines)
              EXPECT_LE(width_of(line), columns) << columns << 'x' << rows << ": " << text_of(line);
            if (columns >= static_cast<int>(state.size())) {
              EXPECT_THAT(all_text(screen), HasSubstr(state)) << columns << 'x' << rows;
            }
          }
        }
  }
  EXPECT_EQ(seen.size(), 8U) << "a state is not tried";
}

TEST(TopScreen, EveryMatterIsOnSomePageOfASmallTerminalAndOnTheOneOfALargeOne) {
  const CellView view = busy_cell();
  const std::vector<const char*> all{"8500 rpm",
                                     "11220 rpm",
                                     "748.0 Hz, nearest mode 5 (752.0 Hz)",
                                     "indicator",
                                     "margin     -0.18; depth 3.60 mm, limit 2.96 mm, chatter expected at 756.1 Hz",
                                     "Spectrum, accelerometer 1 (s: next)",
                                     "Stability lobes",
                                     "Corrections",
                                     "limited by: speed range, path, no stable setting known",
                                     "Events",
                                     "chatter onset (structural), 21.5 Hz",
                                     "! doubts: ",
                                     "25598.5 of 25600 Hz (-0.006 %), ! lost 3, ! gaps 1",
                                     "! 9000.0 of 10000 Hz (-10.000 %)",
                                     "! CAN, dropped by the kernel 12",
                                     "! LCM to here, not readable 5",
                                     "OUT OF TIME",
                                     "p99.9",
                                     "decision        12.5     40.0     99.5   4700.2",
                                     "Spread"};
  TopScene scene = scene_at();
  scene.unreadable = 5;
  const std::string small = every_page(view, scene, 80, 24);
  for (const char* what : all) EXPECT_THAT(small, HasSubstr(what));
  const TopScreen large = draw_top(view, scene, 240, 67);
  EXPECT_EQ(large.pages, 1);
  for (const char* what : all) EXPECT_THAT(all_text(large), HasSubstr(what));
  const TopScreen whole = draw_top(view, scene, 100, 0);
  EXPECT_EQ(whole.pages, 1);
  for (const char* what : all) EXPECT_THAT(all_text(whole), HasSubstr(what));
  EXPECT_THAT(all_text(whole), Not(HasSubstr("more rows"))) << "a snapshot is whole";
}

TEST(TopScreen, WhatIsCutIsSaid) {
  const CellView view = busy_cell();
  const std::string small = every_page(view, scene_at(), 80, 24);
  EXPECT_THAT(small, HasSubstr("more rows"));
  EXPECT_THAT(small, HasSubstr("tab page 1 of "));
  TopScene paused = scene_at(kHeard_ns + 1'200'000'000);
  paused.paused = true;
  EXPECT_THAT(all_text(draw_top(view, paused, 80, 24)), HasSubstr("PAUSED"));
  EXPECT_THAT(all_text(draw_top(view, paused, 80, 24)), HasSubstr("last heard 1 s ago"));
}

TEST(TopScreen, WithoutADaemonItSaysHowToStartIt) {
  EXPECT_THAT(all_text(draw_top(CellView{}, scene_at(), 80, 24)), HasSubstr("stillcutd CELL"));
  const CellView gone = busy_cell();
  const std::string text = all_text(draw_top(gone, scene_at(kHeard_ns + 9'000'000'000), 80, 24));
  EXPECT_THAT(text, HasSubstr("no daemon: nothing was heard of the daemon for 9 s"));
  EXPECT_THAT(text, HasSubstr("last heard 9 s ago"));
}

// The operating point stands where its speed and depth are, above the lobes where the cut is too deep.
TEST(TopScreen, TheOperatingPointMovesInTheLobes) {
  int before = -1;
  for (const double rpm : {6000.0, 8000.0, 10000.0, 12000.0, 14000.0}) {
    CellView view;
    MonitorReport monitor = monitor_in_chatter();
    monitor.spindle_speed_rpm = rpm;
    view.take(monitor, kHeard_ns);
    view.take(some_lobes(), kHeard_ns);
    const std::string text = every_page(view, scene_at(), 80, 40);
    int at = -1;
    std::istringstream lines{text.substr(text.find("Stability lobes"))};
    std::string line;
    std::getline(lines, line);
    while (at < 0 && std::getline(lines, line))
      if (const auto x = line.find('X'); x != std::string::npos) at = width_of(line.substr(0, x));
    EXPECT_GT(at, before) << rpm;
    before = at;
  }
  EXPECT_EQ(before, 79) << "the highest speed is at the right edge";
}

TEST(TopScreen, WhatComesFromTheNetworkCannotSteerTheTerminal) {
  CellView view;
  view.take(monitor_in_chatter(), kHeard_ns);
  Correction correction = asked_of(CorrectionKind::stop_request, kHeard_ns);
  correction.reason = short_text("\x1b[2J\xff\x07 words");
  view.take(correction, kHeard_ns);
  Event event;
  event.note = short_text("\x1b]0;title\x07");
  view.take(event, kHeard_ns);
  LatencyReport latency;
  latency.stages.push_back({"\x1b[31mstage", 1, 1, 1, 1, 1});
  view.take(latency, kHeard_ns);
  for (const char c : every_page(view, scene_at(), 100, 0))
    EXPECT_TRUE(c == '\n' || (static_cast<unsigned char>(c) >= 0x20 && c != 0x7F));
}

TEST(TopScreen, NumbersThatAreNoneAreSaidToBeUnknown) {
  CellView view;
  MonitorReport empty;
  view.take(empty, kHeard_ns);
  DiagramReport strange = some_lobes();
  strange.max_rpm = strange.min_rpm = kNaN;
  strange.depth_limit_mm.assign(2, std::numeric_limits<float>::quiet_NaN());
  view.take(strange, kHeard_ns);
  SpectrumReport spectrum{kHeard_ns, 0, 0, kNaN, kNaN, kNaN, kNaN, kNaN, {1, 2, 3}};
  view.take(spectrum, kHeard_ns);
  HealthReport health;
  health.sensors.resize(1);
  view.take(health, kHeard_ns);
  const std::string text = every_page(view, scene_at(), 80, 24);
  EXPECT_THAT(text, HasSubstr("spindle    unknown"));
  EXPECT_THAT(text, HasSubstr("margin     unknown"));
  EXPECT_THAT(text, HasSubstr("not known yet"));
}

}  // namespace
}  // namespace stillcut
