#include "dsp/synchronous_filter.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

namespace stillcut {
namespace {

constexpr double kRevolution = 2.0 * std::numbers::pi;  // rad

// Amplitude ratio, after over before, of a tone of `orders` per revolution once the filter has settled.
double gain_at(double orders, double samples_per_revolution, int settle_revolutions = 200) {
  SynchronousFilter filter{1};
  filter.set_samples_per_revolution(samples_per_revolution);
  double before = 0.0, after = 0.0;
  const auto settle = static_cast<long>(settle_revolutions * samples_per_revolution);
  const auto measure = static_cast<long>(64 * samples_per_revolution);
  for (long n = 0; n < settle + measure; ++n) {
    const double turned = static_cast<double>(n) / samples_per_revolution;
    const std::array<float, 1> x = {static_cast<float>(std::sin(kRevolution * orders * turned + 0.3))};
    std::array<float, 1> residual{};
    filter.process(turned - std::floor(turned), x, residual);
    if (n < settle) continue;
    before += static_cast<double>(x[0]) * x[0];
    after += static_cast<double>(residual[0]) * residual[0];
  }
  return std::sqrt(after / before);
}

TEST(SynchronousFilter, TakesOutEverySpindleOrderUpToAQuarterOfTheSamplesOfARevolution) {
  for (const double samples : {66.7, 100.0, 256.0, 461.3, 900.0}) {
    for (int order = 1; order <= samples / 4.0; order += 1 + order / 8) {
      EXPECT_LT(20.0 * std::log10(gain_at(order, samples)), order < samples / 5.0 ? -40.0 : -37.0)
          << order << " of " << samples;
    }
  }
}

TEST(SynchronousFilter, PassesLinesBetweenTheOrdersWithinADecibel) {
  for (const double samples : {66.7, 256.0, 900.0}) {
    for (const double fraction : {0.15, 0.3, 0.5, 0.7, 0.85}) {
      for (const double order : {0.0, 3.0, 8.0, samples / 6.0, samples / 4.0}) {
        const double decibels = 20.0 * std::log10(gain_at(std::floor(order) + fraction, samples));
        EXPECT_NEAR(decibels, 0.0, 1.0) << order + fraction << " of " << samples;
      }
    }
  }
}

// Tooth harmonics of two teeth, runout at the odd orders, and a mean value.
double forced(double turned) {
  double x = 1.0;
  for (int order = 1; order <= 20; ++order)
    x += (order % 2 == 0 ? 10.0 : 3.0) / order * std::cos(kRevolution * order * turned + order);
  return x;
}

TEST(SynchronousFilter, FollowsASpeedRamp) {
  constexpr double kRate_hz = 25600.0;
  SynchronousFilter filter{1};
  double turned = 0.0, before = 0.0, after = 0.0;
  for (int n = 0; n < 3 * 25600; ++n) {
    const double t = n / kRate_hz;
    const double rpm = 3400.0 + 1000.0 * std::max(0.0, t - 1.0);
    turned += rpm / 60.0 / kRate_hz;
    if (n % 500 == 0) filter.set_samples_per_revolution(kRate_hz * 60.0 / rpm);
    const std::array<float, 1> x = {static_cast<float>(forced(turned))};
    std::array<float, 1> residual{};
    filter.process(turned - std::floor(turned), x, residual);
    if (t < 1.0) continue;
    before += x[0] * x[0];
    after += residual[0] * residual[0];
  }
  EXPECT_LT(10.0 * std::log10(after / before), -35.0);
}

TEST(SynchronousFilter, LearnsNothingFromWhatIsNoNumber) {
  SynchronousFilter spoilt{2}, clean{2};
  spoilt.set_samples_per_revolution(100.0);
  clean.set_samples_per_revolution(100.0);
  for (int n = 0; n < 4000; ++n) {
    const double angle = (n % 100) / 100.0;
    const auto x = static_cast<float>(forced(angle));
    const bool bad = n % 397 == 0;
    std::array<float, 2> a{}, b{};
    spoilt.process(angle, std::array{bad ? std::numeric_limits<float>::quiet_NaN() : x, x}, a);
    clean.process(angle, std::array{x, x}, b);
    EXPECT_EQ(a[1], b[1]);
    if (bad) {
      EXPECT_EQ(a[0], 0.0F);
    } else if (n > 3000) {
      EXPECT_NEAR(a[0], b[0], 0.1F);
    }
  }
}

TEST(SynchronousFilter, StartsAnewOnlyWhenTheSpeedAsksForOtherKnots) {
  SynchronousFilter filter{1};
  EXPECT_TRUE(filter.set_samples_per_revolution(256.0));
  std::array<float, 1> residual{};
  for (int n = 0; n < 2560; ++n) filter.process((n % 256) / 256.0, std::array{1.0F}, residual);
  EXPECT_FALSE(filter.set_samples_per_revolution(250.0));
  EXPECT_FALSE(filter.set_samples_per_revolution(262.0));
  EXPECT_GT(filter.learned_revolutions(), 5.0);
  EXPECT_TRUE(filter.set_samples_per_revolution(1000.0));
  EXPECT_EQ(filter.learned_revolutions(), 0.0);
  EXPECT_TRUE(filter.set_samples_per_revolution(100.0));
}

TEST(SynchronousFilter, DoesNotRepeatAKnock) {
  SynchronousFilter filter{1};
  filter.set_samples_per_revolution(256.0);
  std::mt19937 random{1};
  std::normal_distribution<double> normal{0.0, 0.3};
  double quiet = 0.0, echo = 0.0;
  for (int n = 0; n < 256 * 62; ++n) {
    const double since = (n - 256 * 60) / 256.0;  // revolutions since a knock of 200 times the noise
    double x = forced((n % 256) / 256.0) + normal(random);
    if (since >= 0.0) x += 60.0 * std::exp(-8.0 * since) * std::sin(kRevolution * 5.3 * since);
    std::array<float, 1> residual{};
    filter.process((n % 256) / 256.0, std::array{static_cast<float>(x)}, residual);
    if (since >= -2.0 && since < 0.0) quiet += residual[0] * residual[0];
    if (since >= 1.0) echo += residual[0] * residual[0];
  }
  EXPECT_LT(std::sqrt(echo), 4.0 * std::sqrt(quiet));  // learned in full it would be about 10
}

struct Order {
  int order;
  double amplitude;
};

// A filter that has learned orders, the same on every axis but for a quarter of each, and a mean.
SynchronousFilter learned(int axes, double samples, const std::vector<Order>& orders, double mean) {
  SynchronousFilter filter{axes};
  filter.set_samples_per_revolution(samples);
  for (int n = 0; n < 100 * samples; ++n) {
    const double turned = n / samples;
    std::array<float, kMaxAxes> x{}, residual{};
    for (int a = 0; a < axes; ++a) {
      double sum = mean;
      for (const auto& [order, amplitude] : orders)
        sum += amplitude * std::cos(kRevolution * (order * turned + 0.25 * a));
      x[a] = static_cast<float>(sum);
    }
    filter.process(turned - std::floor(turned), {x.data(), static_cast<std::size_t>(axes)}, residual);
  }
  return filter;
}

TEST(SynchronousFilter, TellsHowFarAKnownSumOfOrdersMovesTheSensor) {
  const std::vector<std::vector<Order>> sums = {
      {{1, 3.0}}, {{2, 10.0}}, {{1, 1.0}, {2, 10.0}, {3, 4.0}, {4, 8.0}}, {{4, 10.0}}};
  for (const double samples : {100.0, 256.0, 500.3}) {
    for (const double speed : {200.0, 628.0}) {
      for (const int axes : {1, 2, 3}) {
        for (const auto& orders : sums) {
          double square = 0.0;
          for (const auto& [order, amplitude] : orders) {
            const double moved = amplitude / (order * speed * order * speed);
            square += axes * 0.5 * moved * moved;
          }
          const double told = learned(axes, samples, orders, 9.81).displacement(speed);
          EXPECT_NEAR(told / std::sqrt(square), 1.0, 0.02) << samples << ' ' << orders.size() << ' ' << orders[0].order;
        }
      }
    }
  }
}

TEST(SynchronousFilter, TellsTheLevelOfAKnownWaveWithoutItsMean) {
  for (const double samples : {100.0, 256.0, 500.3}) {
    for (const int axes : {1, 3}) {
      EXPECT_NEAR(learned(axes, samples, {{2, 10.0}, {5, 3.0}}, 9.81).level(), std::sqrt(axes * 0.5 * 109.0),
                  0.02 * std::sqrt(axes * 54.5))
          << samples;
    }
  }
}

TEST(SynchronousFilter, TellsNothingBeforeItHasLearned) {
  SynchronousFilter filter{3};
  EXPECT_EQ(filter.level(), 0.0);
  EXPECT_EQ(filter.displacement(600.0), 0.0);
  filter.set_samples_per_revolution(256.0);
  EXPECT_EQ(filter.level(), 0.0);
  EXPECT_EQ(filter.displacement(600.0), 0.0);
  EXPECT_EQ(learned(1, 256.0, {{2, 10.0}}, 0.0).displacement(0.0), 0.0);
}

TEST(SynchronousFilter, KeepsTheMeanAndForgetsTheOrders) {
  SynchronousFilter filter = learned(2, 256.0, {{2, 10.0}, {5, 3.0}}, 9.81);
  EXPECT_NEAR(filter.mean(0), 9.81, 0.05);
  EXPECT_NEAR(filter.mean(1), 9.81, 0.05);
  filter.forget();
  EXPECT_NEAR(filter.level(), 0.0, 1e-4);
  EXPECT_NEAR(filter.displacement(628.0), 0.0, 1e-9);
  EXPECT_EQ(filter.learned_revolutions(), 0.0);
  for (int n = 0; n < 256; ++n) {
    std::array<float, 2> residual{};
    filter.process(n / 256.0, std::array{9.81F, 9.81F}, residual);
    EXPECT_NEAR(residual[0], 0.0, 0.05);
  }
}

// What the watch for slow lines hears.
TEST(SynchronousFilter, PassesALineBelowTheSpindleInResidualAndMeanWithoutTheOrders) {
  for (const double rate_hz : {10000.0, 25600.0}) {
    for (const double memory : {4.0, 16.0}) {
      for (const double line_hz : {5.0, 10.0, 20.0}) {
        const double samples = rate_hz / 100.0;  // 6000 rpm
        SynchronousFilter filter{1};
        filter.set_samples_per_revolution(samples);
        filter.set_memory(memory);
        double in_phase = 0.0, across = 0.0, rest = 0.0;
        const int settle = static_cast<int>(rate_hz), measure = static_cast<int>(rate_hz / 5.0);
        for (int n = 0; n < settle + measure; ++n) {
          const double turned = n / samples, angle = kRevolution * line_hz * n / rate_hz;
          const std::array<float, 1> x = {static_cast<float>(forced(turned) + std::sin(angle))};
          std::array<float, 1> residual{};
          filter.process(turned - std::floor(turned), x, residual);
          const double y = residual[0] + filter.mean(0) - 1.0;  // of forced()
          if (n < settle) continue;
          in_phase += 2.0 / measure * y * std::sin(angle);
          across += 2.0 / measure * y * std::cos(angle);
          rest += (y - std::sin(angle)) * (y - std::sin(angle)) / measure;
        }
        EXPECT_NEAR(std::hypot(in_phase, across), 1.0, memory < 10.0 ? 0.07 : 0.02)
            << rate_hz << ' ' << memory << ' ' << line_hz;
        EXPECT_LT(std::sqrt(rest), 0.2) << rate_hz << ' ' << memory << ' ' << line_hz;  // of 7.5
      }
    }
  }
}

TEST(SynchronousFilter, TellsTheContentOfEveryOrderItHasLearned) {
  std::mt19937 random{3};
  std::uniform_real_distribution<double> share{0.0, 1.0};
  for (int i = 0; i < 30; ++i) {
    const double samples = 60.0 + 400.0 * share(random);
    const int order = 1 + static_cast<int>(0.2 * samples * share(random));
    const double amplitude = 0.5 + 3.0 * share(random), phase = kRevolution * share(random);
    SynchronousFilter filter{1};
    filter.set_samples_per_revolution(samples);
    filter.set_memory(4.0);
    for (int n = 0; n < static_cast<int>(40.0 * samples); ++n) {
      const double turned = n / samples;
      const std::array<float, 1> x = {static_cast<float>(7.0 + std::cos(kRevolution * turned) +
                                                         amplitude * std::cos(kRevolution * order * turned + phase))};
      std::array<float, 1> residual{};
      filter.process(turned - std::floor(turned), x, residual);
    }
    const std::complex<double> expected = std::polar(amplitude, phase) + (order == 1 ? 1.0 : 0.0);
    EXPECT_LT(std::abs(std::complex<double>{filter.content(order, 0)} - expected), 0.03 * std::abs(expected) + 0.01)
        << samples << " samples a revolution, order " << order;
  }
}

}  // namespace
}  // namespace stillcut
