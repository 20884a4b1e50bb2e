#include "dsp/decay_watch.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "dsp/numbers.hpp"
#include "tests/dsp/synthetic_cut.hpp"

namespace stillcut {
namespace {

constexpr double kRate_hz = 10000.0;

// A mode of rms 1 that white noise keeps ringing.
struct RingingMode {
  std::complex<double> turn, z;

  RingingMode(double hz, double decay_per_s)
      : turn{std::exp(std::complex<double>{-decay_per_s, 2.0 * std::numbers::pi * hz} / kRate_hz)} {}
  double next(double white) {
    z = z * turn + std::sqrt(1.0 - std::norm(turn)) * white;
    return z.real();
  }
};

// What the watch says of such a mode in white noise of its own, rms over rms.
ModeDecay measured(double hz, double decay_per_s, double noise, std::uint32_t seed) {
  std::mt19937 random{seed};
  std::normal_distribution<double> normal;
  LineWatch lines{1, kRate_hz, {}};
  DecayWatch decay{1};
  const ExpectedMode mode{hz * 1.01, 0.02};  // the map's, a little off
  RingingMode ringing{hz, decay_per_s};
  int hops = 0;
  for (long n = 0; n < static_cast<long>(5.0 * kRate_hz); ++n) {
    const double heard = ringing.next(normal(random));
    const auto x = static_cast<float>(heard + noise * normal(random));
    if (lines.push(std::span<const float>{&x, 1}) && ++hops > 8) decay.step(lines, {&mode, 1});
  }
  return decay.slowest();
}

TEST(DecayWatch, MeasuresHowFastAModeDiesOutWithinAThird) {
  for (const double decay_per_s : {6.0, 10.0, 16.0}) {
    double sum = 0.0;
    int found = 0;
    for (std::uint32_t seed = 0; seed < 12; ++seed) {
      const ModeDecay decay = measured(500.0 + 37.0 * seed, decay_per_s, 1.0, seed);
      if (std::isnan(decay.per_s)) continue;
      sum += decay.per_s;
      ++found;
    }
    EXPECT_GE(found, 10) << decay_per_s;
    EXPECT_NEAR(sum / found, decay_per_s, 0.34 * decay_per_s);
  }
}

TEST(DecayWatch, SaysThatItCannotTellInNoiseAndOfAWellDampedMode) {
  for (std::uint32_t seed = 0; seed < 12; ++seed) {
    EXPECT_TRUE(std::isnan(measured(700.0, 200.0, 0.5, seed).per_s));
    EXPECT_TRUE(std::isnan(measured(700.0, 10.0, 30.0, seed).per_s));
  }
}

// A recorded sound cut in which a mode of 712 Hz rings in the noise of the force, alike on every axis.
SyntheticLog with_ringing_mode(const SyntheticCut& cut, double decay_per_s, double rms) {
  SyntheticLog log = record(cut);
  std::mt19937 random{5};
  std::normal_distribution<double> normal;
  RingingMode mode{712.0, decay_per_s};
  for (SampleBlock& block : log.blocks) {
    for (std::size_t i = 0; i < block.samples; ++i) {
      const auto heard = static_cast<float>(rms * mode.next(normal(random)));
      for (auto& axis : block.acceleration) axis[i] += heard;
    }
  }
  return log;
}

TEST(Monitor, ShowsAFadingMarginBeforeAnythingIsChatter) {
  double before = kInfinity;
  for (const double decay_per_s : {16.0, 8.0, 4.0}) {
    SyntheticCut cut;
    cut.duration_s = 4.0;
    cut.rate_hz = kRate_hz;
    const SyntheticLog log = with_ringing_mode(cut, decay_per_s, 0.5);
    Monitor monitor{monitor_settings(cut)};
    const ExpectedMode mode{720.0, 0.02};
    monitor.expect({&mode, 1}, kNaN);
    double last = kNaN;
    const auto events = play(log, monitor, [&](const MonitorView& view) { last = view.decay_per_s; });
    EXPECT_TRUE(only(events, EventType::chatter_onset).empty());
    EXPECT_LT(last, before) << decay_per_s;
    EXPECT_LT(last, 2.5 * decay_per_s);  // the synchronous filter takes part of the line away
    before = last;
  }
}

// Order 8 of a two-toothed tool stands on a mode and is most of the vibration.
SyntheticCut forced_on_a_mode() {
  SyntheticCut cut;
  cut.duration_s = 2.0;
  cut.rate_hz = kRate_hz;
  cut.spoil = [](SampleBlock& block, double t) {
    for (int i = 0; t > 0.5 && i < block.samples; ++i) {
      const double at = t - (block.samples - 1 - i) / kRate_hz;
      for (auto& axis : block.acceleration)
        axis[static_cast<std::size_t>(i)] += static_cast<float>(30.0 * std::sin(2.0 * std::numbers::pi * 800.0 * at));
    }
  };
  return cut;
}

TEST(Monitor, TellsForcedVibrationOnAModeOnceAndNeverCallsItRegenerative) {
  const SyntheticCut cut = forced_on_a_mode();
  Monitor monitor{monitor_settings(cut)};
  const ExpectedMode mode{802.0, 0.02};
  monitor.expect({&mode, 1}, kNaN);
  const auto events = play(record(cut), monitor, [](const MonitorView&) {});
  const auto forced = only(events, EventType::forced_vibration);
  ASSERT_EQ(forced.size(), 1U);
  EXPECT_NEAR(forced[0].frequency_hz, 800.0, 1.0);
  EXPECT_EQ(forced[0].kind, ChatterKind::unknown);
  EXPECT_NE(std::string_view{forced[0].note.data()}.find("order 8"), std::string_view::npos);
  EXPECT_TRUE(only(events, EventType::chatter_onset).empty());
}

TEST(Monitor, ForgetsTheDecayOfModesThatAreNoLongerExpected) {
  SyntheticCut cut;
  cut.duration_s = 3.0;
  cut.rate_hz = kRate_hz;
  const SyntheticLog log = with_ringing_mode(cut, 4.0, 0.5);
  Monitor monitor{monitor_settings(cut)};
  const ExpectedMode near{715.0, 0.02}, far{1500.0, 0.02};
  monitor.expect({&near, 1}, kNaN);
  bool moved = false;
  double before = kNaN, after = 0.0;
  play(log, monitor, [&](const MonitorView& view) {
    const double t = static_cast<double>(view.stamp_ns - kSyntheticOrigin_ns) * 1e-9;
    if (t < 2.4) before = view.decay_per_s;
    if (t >= 2.4 && !moved) monitor.expect({&far, 1}, kNaN), moved = true;
    after = view.decay_per_s;
  });
  EXPECT_TRUE(std::isfinite(before));
  EXPECT_TRUE(std::isnan(after));
}

TEST(Monitor, TellsNoForcedVibrationWhereNoModeIsNear) {
  const SyntheticCut cut = forced_on_a_mode();
  Monitor monitor{monitor_settings(cut)};
  const ExpectedMode mode{850.0, 0.02};
  monitor.expect({&mode, 1}, kNaN);
  EXPECT_TRUE(only(play(record(cut), monitor, [](const MonitorView&) {}), EventType::forced_vibration).empty());
}

}  // namespace
}  // namespace stillcut
