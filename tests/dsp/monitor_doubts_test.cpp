// When the monitor cannot tell, it must say so: a fault event, the state, no indicator, and no chatter out of bad data.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

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

// How long after what was bad first came (at bad_s) a fault was told, and the state says so: seconds, by the arrival
// of the frame that brought it about.
struct Delay {
  double fault_s = 1e9, state_s = 1e9;
};

Delay delay_after(const SyntheticLog& log, const SyntheticCut& cut, double bad_s) {
  Monitor monitor{monitor_settings(cut)};
  monitor.set_origin(kSyntheticOrigin_ns);
  Delay delay;
  std::size_t next = 0;
  for (const SampleBlock& block : log.blocks) {
    for (; next < log.speeds.size() && log.speeds[next].stamp_ns <= block.stamp_ns; ++next) {
      monitor.add_speed(log.speeds[next]);
    }
    monitor.advance(block.stamp_ns);
    monitor.add_samples(block);
    const double since_s = static_cast<double>(block.stamp_ns - kSyntheticOrigin_ns) * 1e-9 - bad_s;
    if (since_s >= 0.0) {
      if (!only({monitor.events().begin(), monitor.events().end()}, EventType::fault).empty()) {
        delay.fault_s = std::min(delay.fault_s, since_s);
      }
      if (monitor.view().state == State::cannot_tell) delay.state_s = std::min(delay.state_s, since_s);
    }
    monitor.clear_events();
  }
  return delay;
}

constexpr double kDeadline_s = 0.01;

class MonitorDeadline : public testing::TestWithParam<double> {
 protected:
  MonitorDeadline() {
    cut_.rate_hz = GetParam();
    cut_.axes = 1;
    cut_.duration_s = bad_s_ + 0.1;
  }

  void expect_in_time(double bad_s) {
    const Delay delay = delay_after(record(cut_), cut_, bad_s);
    EXPECT_LE(delay.fault_s, kDeadline_s);
    EXPECT_LE(delay.state_s, kDeadline_s);
  }

  // Spoils samples from `first` on, where the deadline starts.
  void expect_in_time_from(long first, const std::function<void(SampleBlock&, int)>& spoil) {
    cut_.spoil = [&, first](SampleBlock& block, double t) {
      const long last = std::lround(t * cut_.rate_hz);
      for (int i = 0; i < block.samples; ++i) {
        if (last - (block.samples - 1 - i) >= first) spoil(block, i);
      }
    };
    expect_in_time(static_cast<double>(first) / cut_.rate_hz);
  }

  // Anywhere in a frame and in a hop.
  [[nodiscard]] std::vector<long> firsts() const {
    const auto n = static_cast<long>(bad_s_ * cut_.rate_hz);
    return {n, n + 7, n + 33, n + 50};
  }

  SyntheticCut cut_;
  double bad_s_ = 0.9;
};

TEST_P(MonitorDeadline, SaturationIsToldWithinTenMilliseconds) {
  for (const long first : firsts()) {
    expect_in_time_from(first, [](SampleBlock& block, int i) {
      block.acceleration[0][i] = 50.0F;
      block.full_scale[0] |= std::uint64_t{1} << i;
    });
  }
}

TEST_P(MonitorDeadline, AStuckSensorIsToldWithinTenMilliseconds) {
  for (const long first : firsts()) {
    expect_in_time_from(first, [](SampleBlock& block, int i) { block.acceleration[0][i] = 1.25F; });
  }
}

TEST_P(MonitorDeadline, SixteenEqualSamplesAreToldWithinTenMilliseconds) {
  for (const long first : firsts()) {
    int left = 16;
    expect_in_time_from(first, [&](SampleBlock& block, int i) {
      if (left-- > 0) block.acceleration[0][i] = 1.25F;
    });
  }
}

// Also where a frame holds as many samples as it can, two hops at 10 kHz.
TEST_P(MonitorDeadline, ASingleNanIsToldWithinTenMilliseconds) {
  for (const int samples_per_frame : {10, kMaxSamplesPerBlock}) {
    cut_.samples_per_frame = samples_per_frame;
    for (const long first : firsts()) {
      int left = 1;
      expect_in_time_from(first, [&](SampleBlock& block, int i) {
        if (left-- > 0) block.acceleration[0][i] = std::numeric_limits<float>::quiet_NaN();
      });
    }
  }
}

// Without a counter frames that come up to 50 ms late may have waited for the bus, so only a longer gap shows.
TEST_P(MonitorDeadline, AGapIsToldWithinTenMillisecondsOfTheFrameThatFollows) {
  for (const auto& [has_counter, gap_s] : {std::pair{true, 0.02}, {true, 0.06}, {false, 0.06}}) {
    for (const double from_s : {bad_s_, bad_s_ + 0.0013}) {
      SCOPED_TRACE(gap_s);
      cut_.has_counter = has_counter;
      const double to_s = from_s + gap_s;
      cut_.frame_is_sent = [=](double t) { return t < from_s || t > to_s; };
      expect_in_time(to_s);
    }
  }
}

TEST_P(MonitorDeadline, AnImplausibleSpeedIsToldWithinTenMilliseconds) {
  for (const double told : {-600.0, 0.0, 1e6, std::nan("")}) {
    for (const double from_s : {bad_s_, bad_s_ + 0.0011}) {
      SCOPED_TRACE(told);
      SyntheticLog log = record(cut_);
      double bad_s = 1e9;
      for (SpindleReading& reading : log.speeds) {
        const double t = static_cast<double>(reading.stamp_ns - kSyntheticOrigin_ns) * 1e-9;
        if (t < bad_s_) continue;
        reading.stamp_ns += std::llround((from_s - bad_s_) * 1e9);
        reading.speed = told;
        bad_s = std::min(bad_s, t + from_s - bad_s_);
      }
      const Delay delay = delay_after(log, cut_, bad_s);
      EXPECT_LE(delay.fault_s, kDeadline_s);
      EXPECT_LE(delay.state_s, kDeadline_s);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Rates, MonitorDeadline, testing::Values(10000.0, 25600.0, 50000.0),
                         [](const auto& info) { return std::to_string(static_cast<int>(info.param)) + "Hz"; });

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
