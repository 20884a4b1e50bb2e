// When the monitor cannot tell, it must say so: a fault event, the state, no indicator, and no chatter out of bad data.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "tests/dsp/synthetic_cut.hpp"

namespace stillcut {
namespace {

constexpr double kBad_s = 1.5;  // where the data go bad

struct Outcome {
  std::vector<Event> faults, onsets;
  MonitorView at_end;
  double first_cannot_tell_s = -1.0;  // after the warm-up
};

Outcome outcome(const SyntheticCut& cut, bool has_speed_signal = true) {
  MonitorSettings settings = monitor_settings(cut);
  settings.has_speed_signal = has_speed_signal;
  settings.nominal_speed = cut.speed_rpm(0.0) * std::numbers::pi / 30.0;
  Monitor monitor{settings};
  Outcome out;
  const auto events = play(record(cut), monitor, [&](const MonitorView& view) {
    const double t = static_cast<double>(view.stamp_ns - kSyntheticOrigin_ns) * 1e-9;
    EXPECT_EQ(view.state == State::cannot_tell, std::isnan(view.indicator) && view.state != State::idle);
    if (t > 1.0 && view.state == State::cannot_tell && out.first_cannot_tell_s < 0.0) out.first_cannot_tell_s = t;
    out.at_end = view;
  });
  out.faults = only(events, EventType::fault);
  out.onsets = only(events, EventType::chatter_onset);
  return out;
}

void expect_fault(const Outcome& out, const char* words, double within_s) {
  ASSERT_EQ(out.faults.size(), 1U);
  EXPECT_NE(std::string{out.faults[0].note.data()}.find(words), std::string::npos) << out.faults[0].note.data();
  EXPECT_GE(seconds(out.faults[0]), kBad_s - 0.001);
  EXPECT_LE(seconds(out.faults[0]), kBad_s + within_s);
  EXPECT_NEAR(out.first_cannot_tell_s, seconds(out.faults[0]), 0.005);
  EXPECT_TRUE(out.onsets.empty());
}

SyntheticCut spoilt(double to_s, void (*spoil)(SampleBlock&)) {
  SyntheticCut cut;
  cut.duration_s = 3.0;
  cut.spoil = [=](SampleBlock& block, double t) {
    if (t >= kBad_s && t < to_s) spoil(block);
  };
  return cut;
}

void fill(SampleBlock& block, float value) {
  for (int i = 0; i < block.samples; ++i) block.acceleration[1][i] = value;
}

TEST(MonitorDoubts, NanIsAFaultAndPasses) {
  const auto out =
      outcome(spoilt(1.6, [](SampleBlock& b) { b.acceleration[0][3] = std::numeric_limits<float>::quiet_NaN(); }));
  expect_fault(out, "no numbers", 0.01);
  EXPECT_EQ(out.at_end.state, State::cut);
  EXPECT_EQ(out.at_end.doubts, kNoDoubt);
}

TEST(MonitorDoubts, InfinityIsAFault) {
  expect_fault(
      outcome(spoilt(9.0, [](SampleBlock& b) { b.acceleration[2][0] = -std::numeric_limits<float>::infinity(); })),
      "no numbers", 0.01);
}

TEST(MonitorDoubts, AStuckAxisIsAFault) {
  const auto out = outcome(spoilt(9.0, [](SampleBlock& b) { fill(b, 1.25F); }));
  expect_fault(out, "stuck", 0.01);
  EXPECT_EQ(out.at_end.state, State::cannot_tell);
}

TEST(MonitorDoubts, SaturationIsAFault) {
  expect_fault(outcome(spoilt(9.0,
                              [](SampleBlock& b) {
                                fill(b, 50.0F);
                                b.full_scale[1] = (1U << b.samples) - 1U;
                              })),
               "saturated", 0.01);
}

TEST(MonitorDoubts, LostFramesAreToldAndBridged) {
  for (const bool has_counter : {true, false}) {
    SyntheticCut cut;
    cut.has_counter = has_counter;
    cut.frame_is_sent = [](double t) { return t < kBad_s || std::fmod(t, 0.25) > 0.0005; };
    const auto out = outcome(cut);
    EXPECT_TRUE(out.onsets.empty());
    EXPECT_EQ(out.at_end.state, State::cut);
    if (has_counter) {
      EXPECT_GE(out.faults.size(), 1U);
      EXPECT_LE(out.faults.size(), 2U);  // once a second, not once a frame
      EXPECT_GT(out.at_end.samples_lost, 0);
    }
  }
}

TEST(MonitorDoubts, AGapLeavesItUnableToTellForAWhile) {
  for (const double gap_s : {0.02, 0.05, 0.09, 0.3}) {
    SyntheticCut cut;
    cut.duration_s = 3.0;
    cut.frame_is_sent = [=](double t) { return t < kBad_s || t > kBad_s + gap_s; };
    const auto out = outcome(cut);
    EXPECT_GE(out.faults.size(), 1U);
    EXPECT_TRUE(out.onsets.empty());
    EXPECT_LT(out.first_cannot_tell_s, kBad_s + gap_s + 0.01);
    EXPECT_GT(out.first_cannot_tell_s, kBad_s - 0.01);
    EXPECT_EQ(out.at_end.state, State::cut) << gap_s;
  }
}

TEST(MonitorDoubts, ASilentSensorIsAFaultAsTimePasses) {
  SyntheticCut cut;
  cut.duration_s = 1.0;
  Monitor monitor{monitor_settings(cut)};
  play(record(cut), monitor, [](const MonitorView&) {});
  for (int ms = 1000; ms < 3000; ++ms) monitor.advance(kSyntheticOrigin_ns + ms * 1'000'000LL);
  ASSERT_EQ(monitor.events().size(), 1U);
  EXPECT_STREQ(monitor.events()[0].note.data(), describe(kSensorSilent));
  EXPECT_NEAR(seconds(monitor.events()[0]), 1.1, 0.002);
  EXPECT_EQ(monitor.view().state, State::cannot_tell);
  EXPECT_TRUE(std::isnan(monitor.view().indicator));
}

TEST(MonitorDoubts, ASensorThatNeverSpeaksIsAFault) {
  Monitor monitor{monitor_settings(SyntheticCut{})};
  monitor.set_origin(kSyntheticOrigin_ns);
  for (int ms = 0; ms < 1000; ++ms) monitor.advance(kSyntheticOrigin_ns + ms * 1'000'000LL);
  ASSERT_EQ(monitor.events().size(), 1U);
  EXPECT_NEAR(seconds(monitor.events()[0]), 0.5, 0.002);
}

TEST(MonitorDoubts, SpeedThatFallsSilentIsAFault) {
  SyntheticCut cut;
  cut.speed_is_sent = [](double t) { return t < kBad_s; };
  expect_fault(outcome(cut), "speed missing", 0.32);
}

TEST(MonitorDoubts, SpeedThatNeverComesIsAFault) {
  SyntheticCut cut;
  cut.speed_is_sent = [](double) { return false; };
  const auto out = outcome(cut);
  ASSERT_EQ(out.faults.size(), 1U);
  EXPECT_NEAR(seconds(out.faults[0]), 0.3, 0.02);
  EXPECT_EQ(out.at_end.state, State::cannot_tell);
  EXPECT_TRUE(out.onsets.empty());
}

TEST(MonitorDoubts, NegativeZeroHugeOrUnreadableSpeedIsAFault) {
  for (const double told : {-600.0, 0.0, 1e6, std::nan("")}) {
    SyntheticCut cut;
    cut.speed_told = [=](double t, double speed) { return t < kBad_s ? speed : told; };
    const auto out = outcome(cut);
    SCOPED_TRACE(told);
    expect_fault(out, "speed implausible", 0.1);
    EXPECT_EQ(out.at_end.state, State::cannot_tell);
  }
}

TEST(MonitorDoubts, WithoutASpeedSignalTheNominalSpeedServes) {
  SyntheticCut cut;
  cut.speed_is_sent = [](double) { return false; };
  cut.chatter = {733.0, 1.2, 40.0};
  const auto out = outcome(cut, false);
  EXPECT_TRUE(out.faults.empty());
  EXPECT_EQ(out.onsets.size(), 1U);
}

TEST(MonitorDoubts, BlocksOfNoSensorAndEmptyBlocksAreIgnored) {
  Monitor monitor{monitor_settings(SyntheticCut{})};
  SampleBlock block;
  block.stamp_ns = kSyntheticOrigin_ns;
  monitor.add_samples(block);
  block.samples = 10;
  block.sensor = 200;
  monitor.add_samples(block);
  EXPECT_TRUE(monitor.events().empty());
}

}  // namespace
}  // namespace stillcut
