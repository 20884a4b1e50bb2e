// Chatter in which every tooth rings the tool anew, so that no line stands from window to window.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <string_view>
#include <vector>

#include "tests/dsp/synthetic_cut.hpp"

namespace stillcut {
namespace {

constexpr double kRinging_s = 2.0, kGrows_s = 0.8;  // from then on, as large as it gets so much later
constexpr int kRingingTeeth = 2;

// A slow spindle, and from kRinging_s on a ringing of every tooth, `times` as large as the forced vibration.
SyntheticCut ringing_cut(double rpm, double hz, double times, bool repeats, std::uint32_t seed) {
  SyntheticCut cut;
  cut.rate_hz = 10000.0;
  cut.duration_s = 3.5;
  cut.teeth = kRingingTeeth;
  cut.seed = seed;
  cut.speed_rpm = [rpm](double) { return rpm; };
  const double tooth_hz = kRingingTeeth * rpm / 60.0;
  std::mt19937 random{seed};
  std::normal_distribution<double> normal;
  std::vector<double> phases;  // chatter turns on from tooth to tooth
  for (int tooth = 0; tooth < static_cast<int>(cut.duration_s * tooth_hz) + 1; ++tooth) {
    const double turned = 2.0 * std::numbers::pi * 0.37 * (repeats ? tooth % kRingingTeeth : tooth);
    phases.push_back(turned + (repeats ? 0.0 : 0.5 * normal(random)));
  }
  const double largest = times * cut.forced, dt = 1.0 / cut.rate_hz;
  cut.spoil = [=](SampleBlock& block, double last_s) {
    for (int i = 0; i < block.samples; ++i) {
      const double t = last_s - (block.samples - 1 - i) * dt;
      if (t < kRinging_s) continue;
      const double tooth = std::floor(t * tooth_hz), since = t - tooth / tooth_hz,
                   angle = 2.0 * std::numbers::pi * hz * since;
      const double ringing = std::min(1.0, (t - kRinging_s) / kGrows_s) * largest * std::exp(-0.08 * angle) *
                             std::sin(angle + phases[static_cast<std::size_t>(tooth)]);
      for (int a = 0; a < 3; ++a) block.acceleration[a][i] += static_cast<float>(ringing * (a == 0 ? 1.0 : 0.6));
    }
  };
  return cut;
}

std::vector<Event> onsets_of(const SyntheticCut& cut, double mode_hz, bool& single_line) {
  Monitor monitor{monitor_settings(cut)};
  const ExpectedMode mode{mode_hz, 0.03};
  if (mode_hz > 0.0) monitor.expect({&mode, 1}, std::nan(""));
  single_line = true;
  return only(play(record(cut), monitor, [&](const MonitorView& view) { single_line &= view.single_line; }),
              EventType::chatter_onset);
}

TEST(MonitorUnrepeated, IsToldHalfASecondAfterItIsLoud) {
  for (std::uint32_t seed = 1; seed <= 6; ++seed) {
    for (const double rpm : {1200.0, 1500.0}) {
      for (const double mode_hz : {0.0, 360.0}) {
        bool single_line = true;
        const auto onsets = onsets_of(ringing_cut(rpm, 377.0, 15.0, false, seed), mode_hz, single_line);
        ASSERT_FALSE(onsets.empty()) << seed << ' ' << rpm;
        EXPECT_GT(seconds(onsets[0]), kRinging_s);
        EXPECT_LT(seconds(onsets[0]), kRinging_s + kGrows_s + 0.5) << seed << ' ' << rpm;
      }
    }
  }
}

TEST(MonitorUnrepeated, TakesTheSameRingingForForcedWhereItRepeats) {
  for (std::uint32_t seed = 1; seed <= 6; ++seed) {
    for (const double rpm : {1200.0, 1500.0}) {
      bool single_line = true;
      EXPECT_TRUE(onsets_of(ringing_cut(rpm, 377.0, 15.0, true, seed), 360.0, single_line).empty())
          << seed << ' ' << rpm;
    }
  }
}

TEST(MonitorUnrepeated, TakesLittleOfItForNoChatter) {
  for (std::uint32_t seed = 1; seed <= 6; ++seed) {
    bool single_line = true;
    onsets_of(ringing_cut(1500.0, 377.0, 0.3, false, seed), 360.0, single_line);
    EXPECT_TRUE(single_line) << seed;
  }
}

}  // namespace
}  // namespace stillcut
