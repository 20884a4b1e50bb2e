#include "dsp/line_watch.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <vector>

namespace stillcut {
namespace {

struct Result {
  double largest = 0.0;                       // ratio of the strongest candidate over the whole run
  double first_s = -1.0, frequency_hz = 0.0;  // of the first candidate at its limit
  int axis = -1;
};

// White noise of standard deviation `noise(t)`, and a line on the last axis.
Result watch_noise(LineWatch& watch, int axes, double rate_hz, double seconds, unsigned seed,
                   const std::function<double(double)>& noise, const std::function<double(double)>& line) {
  std::mt19937 random{seed};
  std::normal_distribution<float> normal;
  Result result;
  std::array<float, 3> x{};
  for (long n = 0; n < std::lround(seconds * rate_hz); ++n) {
    const double t = static_cast<double>(n) / rate_hz;
    const auto sigma = static_cast<float>(noise(t));
    for (int a = 0; a < axes; ++a) x[static_cast<std::size_t>(a)] = sigma * normal(random);
    x[static_cast<std::size_t>(axes - 1)] += static_cast<float>(line(t));
    if (!watch.push(std::span{x}.first(static_cast<std::size_t>(axes))) || !watch.ready()) continue;
    result.largest = std::max(result.largest, watch.largest_ratio());
    if (watch.largest_ratio() >= 1.0 && result.first_s < 0.0) {
      result.first_s = t;
      result.frequency_hz = watch.candidates()[0].frequency_hz;
      result.axis = watch.candidates()[0].axis;
    }
  }
  return result;
}

double silence(double) { return 0.0; }
double one(double) { return 1.0; }

TEST(LineWatch, StaysBelowItsLimitInWhiteNoise) {
  double minutes = 0.0;
  for (const auto& [rate_hz, axes] : {std::pair{2000.0, 1}, {10000.0, 1}, {10000.0, 3}, {25600.0, 2}}) {
    for (unsigned seed = 1; seed <= 3; ++seed) {
      LineWatch watch{axes, rate_hz, {.limit = 24.0}};  // at the monitor's own limit a line is but a suspect
      const double seconds = 400000.0 / rate_hz;
      const Result result = watch_noise(watch, axes, rate_hz, seconds, seed, one, silence);
      EXPECT_LT(result.largest, 1.0) << rate_hz << ' ' << axes << ' ' << seed;
      EXPECT_GT(result.largest, 0.1);
      minutes += seconds / 60.0;
    }
  }
  EXPECT_GT(minutes, 10.0);
}

TEST(LineWatch, FindsALineThatGrows) {
  for (const double hz : {131.0, 433.0, 750.5, 1499.0, 3801.0}) {
    LineWatch watch{2, 10000.0, {}};
    const auto line = [&](double t) {
      return t < 1.5 ? 0.0
                     : std::min(2.0, 0.05 * std::exp(30.0 * (t - 1.5))) * std::sin(2.0 * std::numbers::pi * hz * t);
    };
    const Result result = watch_noise(watch, 2, 10000.0, 1.8, 4, one, line);
    ASSERT_GT(result.first_s, 1.5) << hz;
    EXPECT_LT(result.first_s, 1.7) << hz;
    EXPECT_NEAR(result.frequency_hz, hz, 20.0);  // half a bin, in the first hop
    EXPECT_EQ(result.axis, 1);
  }
}

TEST(LineWatch, TakesARiseOfAllBinsForNoLine) {
  for (const double factor : {1.5, 2.0, 3.0, 10.0}) {
    LineWatch watch{1, 10000.0, {}};
    const auto step = [&](double t) { return t > 2.0 && t < 4.0 ? factor : 1.0; };
    EXPECT_LT(watch_noise(watch, 1, 10000.0, 6.0, 6, step, silence).largest, 1.0) << factor;
  }
}

TEST(LineWatch, AsksForLessNearPredictedModesAndWhereTheCutIsPredictedUnstable) {
  const auto ratio_of = [](std::span<const ExpectedMode> modes, double margin) {
    LineWatch watch{1, 10000.0, {}};
    watch.set_prior(modes, margin);
    const auto line = [](double t) { return t < 1.5 ? 0.0 : std::sin(2.0 * std::numbers::pi * 740.0 * t); };
    watch_noise(watch, 1, 10000.0, 1.53, 4, one, line);
    return watch.ratio_at(740.0);
  };
  const double nan = std::nan("");
  const ExpectedMode near{732.0, 0.03}, far{1500.0, 0.03};
  const double plain = ratio_of({}, nan);
  EXPECT_NEAR(ratio_of({&near, 1}, nan) / plain, 1.0 / 0.7, 1e-3);
  EXPECT_NEAR(ratio_of({&far, 1}, nan) / plain, 1.0, 1e-3);
  EXPECT_NEAR(ratio_of({}, -0.5) / plain, 1.0 / 0.75, 1e-3);
  EXPECT_NEAR(ratio_of({}, 10.0) / plain, 1.0 / 1.4, 1e-3);
}

TEST(LineWatch, KeepsThePastInOrder) {
  LineWatch watch{1, 1000.0, {}};
  float n = 0.0F;
  for (int i = 0; i < 5000; ++i) {
    if (!watch.push(std::array{n++})) continue;
    const auto kept = watch.kept(0), window = watch.window(0);
    ASSERT_EQ(window.size(), static_cast<std::size_t>(watch.window_length()));
    EXPECT_EQ(window.back(), n - 1.0F);
    EXPECT_EQ(window.data() + window.size(), kept.data() + kept.size());
    for (std::size_t k = kept.size() - 1; k > 0 && kept[k] > 0.0F; --k) ASSERT_EQ(kept[k - 1] + 1.0F, kept[k]);
  }
}

TEST(LineWatch, StartsItsWindowAnewAfterAGap) {
  LineWatch watch{1, 10000.0, {}};
  const auto line = [](double t) { return t < 1.5 ? 0.0 : 2.0 * std::sin(2.0 * std::numbers::pi * 740.0 * t); };
  watch_noise(watch, 1, 10000.0, 1.6, 4, one, line);
  EXPECT_GT(watch.largest_ratio(), 1.0);
  watch.clear_window();
  EXPECT_EQ(watch.largest_ratio(), 0.0);
  EXPECT_TRUE(watch.ready());
}

TEST(WindowLength, SuitsTheTransform) {
  for (double rate = 500.0; rate < 60000.0; rate *= 1.07) {
    const int length = window_length(rate, 0.025);
    EXPECT_EQ(length % 8, 0);
    EXPECT_GE(length / rate, 0.025 - 1e-9);
    EXPECT_NO_THROW(AxesFft{length});
  }
}

}  // namespace
}  // namespace stillcut
