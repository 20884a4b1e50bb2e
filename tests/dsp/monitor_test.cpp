// The monitor from end to end on synthetic cuts: what it must find.
#include "dsp/monitor.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <cstring>
#include <numbers>
#include <random>
#include <stdexcept>
#include <string>

#include "tests/dsp/synthetic_cut.hpp"

namespace stillcut {
namespace {

struct Case {
  SyntheticCut cut;
  std::string name;
};

// Chatter at a random frequency between the orders, growing at a random rate, with one to five teeth.
Case random_case(double rate_hz, int axes, double rpm, unsigned seed) {
  std::mt19937 random{seed * 1000U + static_cast<unsigned>(rpm) + static_cast<unsigned>(axes)};
  std::uniform_real_distribution<double> part{0.0, 1.0};
  SyntheticCut cut;
  cut.rate_hz = rate_hz;
  cut.axes = axes;
  cut.seed = seed;
  cut.teeth = 1 + static_cast<int>(random() % 5);
  cut.duration_s = 2.5;
  cut.speed_rpm = [rpm](double) { return rpm; };
  cut.noise = 0.3 * std::pow(10.0, 0.5 * part(random));
  const double spindle_hz = rpm / 60.0, apart = std::min(8.0, 0.3 * spindle_hz);
  double hz = 300.0 + 1200.0 * part(random);
  const double off = std::remainder(hz, spindle_hz);
  if (std::abs(off) < apart) hz += off > 0.0 ? apart - off : -apart - off;
  cut.chatter = {hz, 1.1, 10.0 + 50.0 * part(random), 1.5, 1.9};
  return {cut, std::to_string(rate_hz) + " Hz, " + std::to_string(axes) + " axes, " + std::to_string(rpm) + " rpm, " +
                   std::to_string(hz) + " Hz"};
}

TEST(Monitor, FindsChatterOnceBeforeItIsLoudAndSaysWhenItEnds) {
  unsigned seed = 0;
  for (const double rate_hz : {10000.0, 25600.0, 50000.0}) {
    for (const int axes : {1, 2, 3}) {
      for (const double rpm : {2000.0, 3330.0, 6000.0, 9000.0, 18000.0}) {
        const auto [cut, name] = random_case(rate_hz, axes, rpm, ++seed);
        SCOPED_TRACE(name);
        double worst_hz = 0.0;
        const double loud_s = cut.chatter.reaches_s(0.5);
        Monitor monitor{monitor_settings(cut)};
        const auto events = play(record(cut), monitor, [&](const MonitorView& view) {
          const double t = static_cast<double>(view.stamp_ns - kSyntheticOrigin_ns) * 1e-9;
          if (!view.chatter || t < loud_s + 0.03 || t > cut.chatter.stop_s) return;
          worst_hz = std::max(worst_hz, std::abs(view.chatter_frequency_hz - cut.chatter.frequency_hz));
        });
        const auto onsets = only(events, EventType::chatter_onset);
        const auto ends = only(events, EventType::chatter_end);
        ASSERT_FALSE(onsets.empty());
        EXPECT_GT(seconds(onsets[0]), cut.chatter.start_s);
        EXPECT_LT(seconds(onsets[0]), loud_s + 0.07);
        EXPECT_NEAR(onsets[0].frequency_hz, cut.chatter.frequency_hz,
                    5.0);  // at a few per cent of the forced amplitude
        EXPECT_LT(worst_hz, 3.0);
        EXPECT_EQ(onsets.back().kind, ChatterKind::regenerative);
        // A second one only to name a kind that the first could not.
        EXPECT_LE(onsets.size(), onsets[0].kind == ChatterKind::unknown ? 2U : 1U);
        ASSERT_EQ(ends.size(), 1U);
        EXPECT_GT(seconds(ends[0]), cut.chatter.stop_s);
        EXPECT_GE(onsets[0].indicator, 1.0);
        EXPECT_EQ(only(events, EventType::fault).size(), 0U);
      }
    }
  }
}

TEST(Monitor, EstimatesWhenChatterBegan) {
  SyntheticCut cut;
  cut.chatter = {733.0, 1.2, 40.0};
  const auto onsets = only(play(cut), EventType::chatter_onset);
  ASSERT_EQ(onsets.size(), 1U);
  const char* start = std::strstr(onsets[0].note.data(), "start=");
  ASSERT_NE(start, nullptr);
  EXPECT_NEAR(std::atof(start + 6), cut.chatter.start_s, 0.1);
}

TEST(Monitor, FindsASecondEpisode) {
  SyntheticCut cut;
  cut.duration_s = 2.0;
  cut.chatter = {733.0, 0.9, 40.0, 1.0, 1.3};
  SyntheticLog log = record(cut);
  const SyntheticLog again = record(cut);
  for (SampleBlock block : again.blocks) {
    block.stamp_ns += 2'000'000'000;
    log.blocks.push_back(block);
  }
  for (SpindleReading reading : again.speeds) log.speeds.push_back({reading.stamp_ns + 2'000'000'000, reading.speed});
  Monitor monitor{monitor_settings(cut)};
  const auto events = play(log, monitor, [](const MonitorView&) {});
  EXPECT_EQ(only(events, EventType::chatter_onset).size(), 2U);
  EXPECT_EQ(only(events, EventType::chatter_end).size(), 2U);
}

TEST(Monitor, EndsChatterAtTheExitOfTheCut) {
  SyntheticCut cut;
  cut.depth = [](double t) { return t > 0.5 && t < 2.0 ? 1.0 : 0.0; };
  cut.chatter = {733.0, 1.0, 40.0, 1.0, 2.0, 400.0};
  const auto events = play(cut);
  const auto ends = only(events, EventType::chatter_end), exits = only(events, EventType::cut_exit);
  ASSERT_EQ(ends.size(), 1U);
  ASSERT_EQ(exits.size(), 1U);
  EXPECT_LT(seconds(ends[0]), 2.3);
}

TEST(Monitor, NamesNoKindFarFromEveryMode) {
  SyntheticCut cut;
  cut.chatter = {733.0, 1.2, 40.0};
  for (const auto& [mode_hz, kind] : {std::pair{700.0, ChatterKind::regenerative}, {1500.0, ChatterKind::unknown}}) {
    Monitor monitor{monitor_settings(cut)};
    const ExpectedMode mode{mode_hz, 0.03};
    monitor.expect({&mode, 1}, std::nan(""));
    const auto onsets = only(play(record(cut), monitor, [](const MonitorView&) {}), EventType::chatter_onset);
    ASSERT_EQ(onsets.size(), 1U);
    EXPECT_EQ(onsets[0].kind, kind);
  }
}

// Chatter shows at its own frequency and a tooth passing above it, where less motion may be the louder acceleration.
TEST(Monitor, ReportsTheLineNearAnExpectedModeWhereASidebandIsLouder) {
  unsigned seed = 0;
  for (const double rate_hz : {10000.0, 50000.0}) {
    for (const double hz : {427.0, 523.0}) {
      for (const double sideband : {1.2, 1.5}) {
        SyntheticCut cut;
        cut.rate_hz = rate_hz;
        cut.axes = 1;
        cut.seed = ++seed;
        cut.teeth = 3;
        cut.duration_s = 1.4;
        cut.speed_rpm = [](double) { return 7200.0; };
        cut.chatter = {hz, 1.0, 40.0, 1.0};
        cut.chatter.sideband = sideband;
        const SyntheticLog log = record(cut);
        const auto first_onset_hz = [&](double mode_hz) {
          Monitor monitor{monitor_settings(cut)};
          const ExpectedMode mode{mode_hz, 0.03};
          monitor.expect({&mode, 1}, std::nan(""));
          const auto onsets = only(play(log, monitor, [](const MonitorView&) {}), EventType::chatter_onset);
          return onsets.empty() ? 0.0 : onsets[0].frequency_hz;
        };
        EXPECT_NEAR(first_onset_hz(0.95 * hz), hz, 5.0) << rate_hz << " Hz, sideband " << sideband;
        EXPECT_NEAR(first_onset_hz(3000.0), hz + 360.0, 5.0);  // where nothing tells that it is a sideband
        EXPECT_NEAR(first_onset_hz(1.05 * hz), hz, 5.0) << rate_hz << " Hz, sideband " << sideband;
      }
    }
  }
}

TEST(Monitor, FindsChatterWithLateAndMissingSpeedMessages) {
  SyntheticCut cut;
  cut.chatter = {733.0, 1.2, 30.0};
  cut.speed_jitter_s = 0.005;
  cut.speed_is_sent = [](double t) { return std::fmod(t, 0.3) > 0.05; };
  const auto onsets = only(play(cut), EventType::chatter_onset);
  ASSERT_EQ(onsets.size(), 1U);
  EXPECT_LT(seconds(onsets[0]), cut.chatter.reaches_s(0.5) + 0.06);
}

TEST(Monitor, FindsChatterOnASpeedRamp) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    SyntheticCut cut;
    cut.seed = seed;
    cut.duration_s = 2.5;
    cut.speed_rpm = [](double t) { return 5000.0 + 1000.0 * std::max(0.0, t - 0.9); };
    cut.chatter = {733.0, 1.2, 20.0};
    const auto onsets = only(play(cut), EventType::chatter_onset);
    ASSERT_FALSE(onsets.empty());
    EXPECT_LT(seconds(onsets[0]), cut.chatter.reaches_s(0.5) + 0.12);
    EXPECT_NEAR(onsets[0].frequency_hz, 733.0, 5.0);
  }
}

TEST(Monitor, GivesTheSameBitsForTheSameInput) {
  SyntheticCut cut;
  cut.chatter = {733.0, 1.2, 30.0, 1.5, 1.9};
  cut.knocks_s = {1.0, 2.5};
  const SyntheticLog log = record(cut);
  const auto run = [&] {
    std::string bits;
    Monitor monitor{monitor_settings(cut)};
    const auto events = play(log, monitor, [&](const MonitorView& view) {
      for (const double value : {view.indicator, view.speed, view.chatter_frequency_hz, view.chatter_amplitude}) {
        bits.append(reinterpret_cast<const char*>(&value), sizeof value);
      }
      bits.push_back(static_cast<char>(view.state));
    });
    for (const Event& event : events) {
      for (const double value : {event.frequency_hz, event.indicator, event.spindle_speed_rpm}) {
        bits.append(reinterpret_cast<const char*>(&value), sizeof value);
      }
      bits += std::to_string(event.stamp_ns) + event.note.data();
    }
    return bits;
  };
  EXPECT_EQ(run(), run());
}

TEST(Monitor, RefusesSensorsThatItCannotWatch) {
  EXPECT_THROW(Monitor{MonitorSettings{}}, std::invalid_argument);
  for (const SensorSettings& sensor :
       {SensorSettings{100.0, 1}, SensorSettings{std::nan(""), 1}, SensorSettings{1000.0, 0}}) {
    MonitorSettings settings;
    settings.sensors = {sensor};
    EXPECT_THROW(Monitor{settings}, std::invalid_argument);
  }
  MonitorSettings many;
  many.sensors.assign(kMaxSensors + 1, SensorSettings{1000.0, 1});
  EXPECT_THROW(Monitor{many}, std::invalid_argument);
}

}  // namespace
}  // namespace stillcut
