// Chatter of the robot's structure: lines of a few hertz that grow, beside the tool's chatter or without it.
#include <gtest/gtest.h>

#include <cmath>
#include <string_view>
#include <utility>
#include <vector>

#include "tests/dsp/synthetic_cut.hpp"

namespace stillcut {
namespace {

// A line of 12 Hz that is loud at two seconds, dies from 2.1 s on and is gone a second later.
SyntheticCut structural_cut() {
  SyntheticCut cut;
  cut.rate_hz = 10000.0;
  cut.duration_s = 3.2;
  cut.gravity = 9.81;
  cut.slow = {12.0, 0.9, 1.4, 3.0, 2.1, 0.7};
  return cut;
}

std::vector<Event> play_with_modes(const SyntheticCut& cut, std::vector<ExpectedMode> modes) {
  Monitor monitor{monitor_settings(cut)};
  monitor.expect(modes, std::nan(""));
  return play(record(cut), monitor, [](const MonitorView&) {});
}

std::vector<Event> of_kind(const std::vector<Event>& events, EventType type, ChatterKind kind) {
  std::vector<Event> found;
  for (const Event& event : only(events, type)) {
    if (event.kind == kind) found.push_back(event);
  }
  return found;
}

TEST(MonitorStructural, CallsALineThatGrowsNearAModeOnceAndSaysWhenItHasDied) {
  for (const auto& [rate_hz, axes] : {std::pair{10000.0, 1}, {10000.0, 3}, {25600.0, 2}, {50000.0, 1}}) {
    for (const double mode_hz : {10.0, 14.0}) {
      SyntheticCut cut = structural_cut();
      cut.rate_hz = rate_hz;
      cut.axes = axes;
      SCOPED_TRACE(rate_hz);
      const auto events = play_with_modes(cut, {{mode_hz, 0.02}});
      const auto onsets = only(events, EventType::chatter_onset), ends = only(events, EventType::chatter_end);
      ASSERT_EQ(onsets.size(), 1U);
      EXPECT_EQ(onsets[0].kind, ChatterKind::structural);
      EXPECT_NEAR(onsets[0].frequency_hz, 12.0, 1.0);
      EXPECT_GT(seconds(onsets[0]), cut.slow.start_s);
      EXPECT_LT(seconds(onsets[0]), cut.slow.reaches_s(1.0));
      ASSERT_EQ(ends.size(), 1U);
      EXPECT_EQ(ends[0].kind, ChatterKind::structural);
      EXPECT_NEAR(ends[0].frequency_hz, 12.0, 1.0);
      EXPECT_GT(seconds(ends[0]), cut.slow.stop_s);
      EXPECT_EQ(only(events, EventType::fault).size(), 0U);
      EXPECT_EQ(only(events, EventType::cut_exit).size(), 0U);
    }
  }
}

TEST(MonitorStructural, TellsTheFrequencyOfAnyModeWithinAHertz) {
  for (const double hz : {8.0, 10.0, 15.5, 20.0}) {
    SyntheticCut cut = structural_cut();
    cut.slow = {hz, 0.9, std::pow(1.4, 12.0 / hz)};
    double worst_hz = 0.0;
    Monitor monitor{monitor_settings(cut)};
    const ExpectedMode mode{0.95 * hz, 0.02};
    monitor.expect({&mode, 1}, std::nan(""));
    const auto events = play(record(cut), monitor, [&](const MonitorView& view) {
      if (view.structural) worst_hz = std::max(worst_hz, std::abs(view.structural_frequency_hz - hz));
    });
    const auto onsets = only(events, EventType::chatter_onset);
    ASSERT_EQ(onsets.size(), 1U) << hz;
    EXPECT_EQ(onsets[0].kind, ChatterKind::structural);
    EXPECT_NEAR(onsets[0].frequency_hz, hz, 1.0);
    EXPECT_LT(worst_hz, 1.0) << hz;
  }
}

TEST(MonitorStructural, HearsItFromOneAxisOfThree) {
  for (int axis = 0; axis < kMaxAxes; ++axis) {
    SyntheticCut cut = structural_cut();
    cut.slow.axes = {};
    cut.slow.axes[axis] = 1.0;
    EXPECT_EQ(of_kind(play_with_modes(cut, {{12.0, 0.02}}), EventType::chatter_onset, ChatterKind::structural).size(),
              1U);
  }
}

TEST(MonitorStructural, AsksForMoreFarFromEveryModeAndWithoutAMap) {
  const SyntheticCut cut = structural_cut();
  double before_s = 0.0;
  for (const auto& modes : {std::vector<ExpectedMode>{{12.0, 0.02}}, {}, {{40.0, 0.02}}}) {
    const auto onsets = only(play_with_modes(cut, modes), EventType::chatter_onset);
    ASSERT_EQ(onsets.size(), 1U);
    EXPECT_GT(seconds(onsets[0]), before_s);
    before_s = seconds(onsets[0]);
  }
}

TEST(MonitorStructural, KeepsItApartFromTheToolsChatterWithAnEndForEach) {
  const ExpectedMode structure{12.0, 0.02}, tool{720.0, 0.03};
  for (const bool tool_ends_first : {true, false}) {
    SyntheticCut cut = structural_cut();
    cut.chatter = {733.0, 1.4, 40.0, 1.5, tool_ends_first ? 1.9 : 2.9};
    cut.slow.stop_s = tool_ends_first ? 2.3 : 1.9;
    cut.duration_s = 3.3;
    const auto events = play_with_modes(cut, {structure, tool});
    std::array<double, 2> end_s{};
    for (const ChatterKind kind : {ChatterKind::structural, ChatterKind::regenerative}) {
      const auto onsets = of_kind(events, EventType::chatter_onset, kind);
      const auto ends = of_kind(events, EventType::chatter_end, kind);
      ASSERT_EQ(onsets.size(), 1U);
      ASSERT_EQ(ends.size(), 1U);
      const bool slow = kind == ChatterKind::structural;
      EXPECT_NEAR(onsets[0].frequency_hz, slow ? 12.0 : 733.0, slow ? 1.0 : 5.0);
      end_s[slow ? 0 : 1] = seconds(ends[0]);
    }
    EXPECT_EQ(end_s[1] < end_s[0], tool_ends_first);
    EXPECT_EQ(only(events, EventType::chatter_onset).size(), 2U);
    EXPECT_EQ(only(events, EventType::chatter_end).size(), 2U);
  }
}

// The first order of 1620 rpm lies at 27 Hz.
SyntheticCut beside_the_first_order(double frequency_hz) {
  SyntheticCut cut = structural_cut();
  cut.duration_s = 4.5;
  cut.speed_rpm = [](double) { return 1620.0; };
  cut.slow = {frequency_hz, 1.8, 1.12, 3.0};
  return cut;
}

TEST(MonitorStructural, HearsAMappedModeBesideASpindleOrderOnceTheOrdersAreKnown) {
  for (const double hz : {22.0, 24.2, 30.5}) {
    const SyntheticCut cut = beside_the_first_order(hz);
    const auto onsets = only(play_with_modes(cut, {{0.98 * hz, 0.02}}), EventType::chatter_onset);
    ASSERT_EQ(onsets.size(), 1U) << hz;
    EXPECT_EQ(onsets[0].kind, ChatterKind::structural);
    EXPECT_NEAR(onsets[0].frequency_hz, hz, 1.0);
  }
}

TEST(MonitorStructural, TakesTheOrderItselfForNoStructureHoweverItGrows) {
  for (const double mode_hz : {25.0, 26.5, 29.0}) {
    const SyntheticCut cut = beside_the_first_order(27.0);
    EXPECT_TRUE(
        of_kind(play_with_modes(cut, {{mode_hz, 0.02}}), EventType::chatter_onset, ChatterKind::structural).empty())
        << mode_hz;
  }
}

TEST(MonitorStructural, EndsItAtTheExitOfTheCut) {
  SyntheticCut cut = structural_cut();
  cut.slow.stop_s = 1e9;
  cut.depth = [](double t) { return t > 0.5 && t < 2.2 ? 1.0 : 0.0; };
  const auto events = play_with_modes(cut, {{12.0, 0.02}});
  const auto onsets = only(events, EventType::chatter_onset), ends = only(events, EventType::chatter_end);
  const auto exits = only(events, EventType::cut_exit);
  ASSERT_EQ(onsets.size(), 1U);
  ASSERT_EQ(ends.size(), 1U);
  ASSERT_EQ(exits.size(), 1U);
  EXPECT_EQ(ends[0].kind, ChatterKind::structural);
  EXPECT_EQ(std::string_view{ends[0].note.data()}, "cut exit");
  EXPECT_EQ(ends[0].stamp_ns, exits[0].stamp_ns);
}

TEST(MonitorStructural, CallsNothingOutOfTheCut) {
  SyntheticCut cut = structural_cut();
  cut.depth = [](double) { return 0.0; };
  EXPECT_TRUE(only(play_with_modes(cut, {{12.0, 0.02}}), EventType::chatter_onset).empty());
}

// What holds for a mapped mode holds for others, of which more is asked.
void expect_no_chatter(SyntheticCut cut, double mode_hz) {
  for (const Event& event : only(play_with_modes(cut, {{mode_hz, 0.02}}), EventType::chatter_onset)) {
    ADD_FAILURE() << "seed " << cut.seed << ", mode " << mode_hz << " Hz: chatter at " << seconds(event) << " s, "
                  << event.frequency_hz << " Hz";
  }
}

TEST(MonitorStructural, CallsNoMotionOfTheRobotChatter) {
  for (const double hz : {1.0, 2.0, 3.0, 4.0}) {
    for (const double mode_hz : {6.0, 8.0, 12.0}) {
      SyntheticCut cut = structural_cut();
      cut.rate_hz = 5000.0;
      cut.slow = {hz, 0.9, 50.0, 1.0, 2.5, 0.5};
      expect_no_chatter(cut, mode_hz);
    }
  }
}

TEST(MonitorStructural, CallsNoModeChatterThatAnEntryOrAKnockRings) {
  for (std::uint32_t seed = 1; seed <= 6; ++seed) {
    for (const double a_cycle : {0.75, 0.94}) {
      SyntheticCut cut = structural_cut();
      cut.rate_hz = 5000.0;
      cut.duration_s = 2.4;
      cut.seed = seed;
      const double hz = 6.5 + 2.1 * seed;
      cut.slow = {hz, 0.5, 1.0, 300.0, 0.5, a_cycle};  // 3 m/s^2 at once
      expect_no_chatter(cut, 1.02 * hz);
      cut.slow.start_s = cut.slow.stop_s = 1.5 + 0.004 * seed;
      cut.knocks_s = {cut.slow.start_s};
      expect_no_chatter(cut, 1.02 * hz);
    }
  }
}

}  // namespace
}  // namespace stillcut
