#include "dsp/order_watch.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "dsp/numbers.hpp"
#include "tests/dsp/synthetic_cut.hpp"

namespace stillcut {
namespace {

constexpr double kRate_hz = 10000.0;

// What the watch makes of a signal in noise with one line that grows, off an order by some hertz, behind the filter
// that takes the orders out.
struct Heard {
  OrderLine line;
  double amplitude = 0.0;  // the true one, in the middle of the newest window
};

Heard listen(double spindle_hz, int order, double off_hz, double growth_per_s, std::mt19937& random) {
  constexpr double kBegins_s = 1.0, kFirst = 0.02, kMemory = 4.0, kLoud = 300.0;
  std::normal_distribution<double> noise{0.0, 0.05};
  LineWatch lines{1, kRate_hz, {}};
  OrderWatch orders{1};
  SynchronousFilter filter{1};
  filter.set_samples_per_revolution(kRate_hz / spindle_hz);
  filter.set_memory(kMemory);
  const double hz = order * spindle_hz + off_hz, two_pi = 2.0 * std::numbers::pi;
  const auto amplitude = [&](double t) {
    return t < kBegins_s ? 0.0 : kFirst * std::exp(growth_per_s * (t - kBegins_s));
  };
  const ExpectedMode mode{hz, 0.02};
  int hops = 0;
  for (long n = 0; n < static_cast<long>(3.0 * kRate_hz); ++n) {
    const double t = static_cast<double>(n) / kRate_hz, turns = spindle_hz * t;
    const auto x = static_cast<float>(amplitude(t) * std::cos(two_pi * hz * t) + noise(random));
    float residual = 0.0F;
    filter.process(turns - std::floor(turns), {&x, 1}, {&residual, 1});
    if (!lines.push(std::span<const float>{&residual, 1}) || ++hops % 2 != 0 || hops < 32) continue;
    const double hop_s = lines.hop_length() / kRate_hz, middle_s = t - 0.5 / lines.bin_hz() + 1.0 / kRate_hz;
    orders.step(lines, filter, {&mode, 1}, {spindle_hz, spindle_hz * middle_s, 2.0 * hop_s * spindle_hz, 2}, 12.0);
    if (const OrderLine line = orders.grown(filter); line.ratio > kLoud) return {line, amplitude(middle_s)};
  }
  return {{.frequency_hz = kNaN}, 0.0};
}

TEST(OrderWatch, NamesFrequencyAndAmplitudeOfWhatGrowsOnOrNearAnOrder) {
  std::mt19937 random{7};
  std::uniform_real_distribution<double> share{0.0, 1.0};
  for (int i = 0; i < 40; ++i) {
    const double spindle_hz = 80.0 + 120.0 * share(random), off_hz = i % 2 == 0 ? 0.0 : 6.0 * share(random) - 3.0;
    const int order = 1 + 2 * (2 + static_cast<int>(3.0 * share(random)));
    const double growth_per_s = spindle_hz * (0.09 + 0.12 * share(random));
    SCOPED_TRACE(testing::Message() << spindle_hz << " Hz, order " << order << ", off by " << off_hz << " Hz, growth "
                                    << growth_per_s);
    const Heard heard = listen(spindle_hz, order, off_hz, growth_per_s, random);
    ASSERT_EQ(heard.line.order, order);
    EXPECT_NEAR(heard.line.frequency_hz, order * spindle_hz + off_hz, 2.0);
    // Roughly: the filter learns less of a fast rise than its memory says, as it holds steps back.
    EXPECT_NEAR(heard.line.amplitude, heard.amplitude, 0.6 * heard.amplitude);
  }
}

TEST(OrderWatch, HearsNothingInNoiseOrInWhatDoesNotGrow) {
  std::mt19937 random{11};
  for (int i = 0; i < 20; ++i) {
    EXPECT_TRUE(std::isnan(listen(100.0, 7, 0.0, 0.0, random).line.frequency_hz));
    EXPECT_TRUE(std::isnan(listen(100.0 + i, 7, 0.0, -20.0, random).line.frequency_hz));
  }
}

SyntheticCut cut_on_an_order(std::uint32_t seed) {
  SyntheticCut cut;
  cut.rate_hz = seed % 2 == 0 ? 10000.0 : 25600.0;
  cut.seed = seed;
  cut.teeth = seed % 3 == 0 ? 4 : 2;
  cut.duration_s = 3.0;
  const double rpm = 4000.0 + 500.0 * seed;
  cut.speed_rpm = [rpm](double) { return rpm; };
  int order = static_cast<int>(std::lround(700.0 / (rpm / 60.0)));
  while (order % cut.teeth == 0) ++order;
  cut.chatter = {order * rpm / 60.0, 1.5, 8.0 + 2.0 * seed, 1.5, 2.2};
  return cut;
}

TEST(Monitor, FindsChatterThatStandsOnAnOrderAndAsksForAnotherSpeed) {
  for (std::uint32_t seed = 1; seed <= 12; ++seed) {
    const SyntheticCut cut = cut_on_an_order(seed);
    SCOPED_TRACE(testing::Message() << "seed " << seed << ", " << cut.teeth << " teeth, " << cut.chatter.frequency_hz
                                    << " Hz");
    MonitorSettings settings = monitor_settings(cut);
    settings.teeth = cut.teeth;
    Monitor monitor{settings};
    const auto events = play(record(cut), monitor, [](const MonitorView&) {});
    const auto onsets = only(events, EventType::chatter_onset);
    ASSERT_EQ(onsets.size(), 1U);
    EXPECT_GT(seconds(onsets[0]), cut.chatter.start_s);
    EXPECT_LT(seconds(onsets[0]), cut.chatter.reaches_s(0.5) + 0.03);
    EXPECT_NEAR(onsets[0].frequency_hz, cut.chatter.frequency_hz, 3.0);
    EXPECT_EQ(onsets[0].kind, ChatterKind::unknown);
    EXPECT_NE(std::string_view{onsets[0].note.data()}.find("speed"), std::string_view::npos);
    EXPECT_EQ(only(events, EventType::chatter_end).size(), 1U);
  }
}

TEST(Monitor, TakesNoChangeOfDepthForChatterOnAnOrder) {
  for (std::uint32_t seed = 1; seed <= 12; ++seed) {
    SyntheticCut cut = cut_on_an_order(seed);
    cut.chatter = {};
    const double took_s = 0.005 * seed;
    cut.depth = [took_s](double t) {
      if (t < 0.4 || t > 2.3) return 0.0;
      return t < 1.4 ? 0.4 : std::min(1.0, 0.4 + 0.6 * (t - 1.4) / took_s);
    };
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    MonitorSettings settings = monitor_settings(cut);
    settings.teeth = cut.teeth;
    Monitor monitor{settings};
    const auto events = play(record(cut), monitor, [](const MonitorView&) {});
    EXPECT_TRUE(only(events, EventType::chatter_onset).empty());
  }
}

}  // namespace
}  // namespace stillcut
