// The whole chain on milling that a simulation of the physics made: what a sensor would have sent goes in as frames,
// and events come out. The truth is the simulation's own.
#include "tests/simulated_cut.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tools/pipeline.hpp"
#include "tools/predictor.hpp"

namespace stillcut {
namespace {

struct Told {
  double time_s;
  Event event;
};

std::vector<Told> events_of(const Cell& cell, const std::vector<CanFrame>& frames) {
  Pipeline pipeline{cell};
  static const LobeDiagram lobes = Predictor{demo_cell()}.nominal().diagram;
  pipeline.core().add_lobes(lobes);
  std::vector<Told> told;
  for (const CanFrame& frame : frames) {
    pipeline.feed(frame);
    for (const Output& output : pipeline.core().outputs()) {
      if (output.type != Output::Type::event) continue;
      told.push_back({static_cast<double>(output.event.stamp_ns - pipeline.core().origin_ns()) * 1e-9, output.event});
    }
    pipeline.core().clear_outputs();
  }
  return told;
}

std::vector<Told> of_type(const std::vector<Told>& all, EventType type) {
  std::vector<Told> some;
  for (const Told& told : all) {
    if (told.event.type == type) some.push_back(told);
  }
  return some;
}

class SimulatedCut : public testing::TestWithParam<std::uint64_t> {};

TEST_P(SimulatedCut, ThatTurnsUnstableIsOneEpisodeAtItsFrequencyWithACorrectionInStep) {
  const Cell cell = demo_cell();
  const auto told = events_of(cell, simulate_cut(cell, kDemoDepth, 6.0, GetParam()));
  const auto onsets = of_type(told, EventType::chatter_onset);
  ASSERT_EQ(onsets.size(), 1U);
  EXPECT_GT(onsets[0].time_s, 2.6);  // the depth limit is crossed at 2.7 s
  EXPECT_LT(onsets[0].time_s, 3.1);
  EXPECT_NEAR(onsets[0].event.frequency_hz, 757.0, 5.0);
  EXPECT_EQ(onsets[0].event.kind, ChatterKind::regenerative);

  const auto ends = of_type(told, EventType::chatter_end);
  ASSERT_EQ(ends.size(), 1U);
  EXPECT_NEAR(ends[0].time_s, 5.4, 0.15);  // the tool is out at 5.4 s
  EXPECT_EQ(of_type(told, EventType::cut_entry).size(), 1U);
  EXPECT_EQ(of_type(told, EventType::cut_exit).size(), 1U);
  EXPECT_TRUE(of_type(told, EventType::fault).empty());

  const auto corrections = of_type(told, EventType::correction);
  ASSERT_FALSE(corrections.empty());
  const double in_step = 60.0 * corrections[0].event.frequency_hz / (2.0 * corrections[0].event.spindle_speed_rpm);
  EXPECT_NEAR(in_step, std::round(in_step), 1e-9);
}

TEST_P(SimulatedCut, ThatStaysStableRaisesNoAlarm) {
  const Cell cell = demo_cell();
  const Schedule stable = {{0.0, 0.0},    {0.5, 0.0},    {0.55, 1.5e-3}, {1.5, 1.5e-3},
                           {1.6, 2.2e-3}, {3.0, 2.2e-3}, {3.05, 0.0}};
  const auto told = events_of(cell, simulate_cut(cell, stable, 3.5, GetParam()));
  EXPECT_TRUE(of_type(told, EventType::chatter_onset).empty());
  EXPECT_TRUE(of_type(told, EventType::correction).empty());
}

TEST_P(SimulatedCut, ThatChattersFromTheFirstSampleIsFoundThoughNoFloorCouldBeLearned) {
  const Cell cell = demo_cell();
  const auto onsets =
      of_type(events_of(cell, simulate_cut(cell, {{0.0, 3.6e-3}}, 2.0, GetParam())), EventType::chatter_onset);
  ASSERT_EQ(onsets.size(), 1U);
  EXPECT_LT(onsets[0].time_s, 0.5);
  EXPECT_NEAR(onsets[0].event.frequency_hz, 757.0, 5.0);
}

INSTANTIATE_TEST_SUITE_P(Seeds, SimulatedCut, testing::Values(1, 2, 3));

}  // namespace
}  // namespace stillcut
