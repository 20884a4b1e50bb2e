#include "dsp/tone.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

namespace stillcut {
namespace {

constexpr double kTwoPi = 2.0 * std::numbers::pi;

struct Line {
  double frequency_hz, amplitude = 1.0, growth_per_s = 0.0, phase = 0.0;
};

std::vector<float> window(const Line& line, double noise, double rate_hz, int length, std::mt19937& random) {
  std::normal_distribution<double> normal;
  std::vector<float> samples(static_cast<std::size_t>(length));
  for (int n = 0; n < length; ++n) {
    const double t = n / rate_hz;
    samples[static_cast<std::size_t>(n)] = static_cast<float>(
        line.amplitude * std::exp(line.growth_per_s * t) * std::sin(kTwoPi * line.frequency_hz * t + line.phase) +
        noise * normal(random));
  }
  return samples;
}

// Rife and Boorstyn 1974, eq. 19: variance of the frequency of a complex tone; a real tone has half the
// signal-to-noise.
double cramer_rao_hz(double amplitude, double noise, double rate_hz, int length) {
  const double n = length;
  return rate_hz / kTwoPi * std::sqrt(24.0 * noise * noise / (amplitude * amplitude * n * (n * n - 1.0)));
}

TEST(AnalyseTone, FindsTheFrequencyNearTheCramerRaoBound) {
  struct Case {
    double rate_hz;
    int length;
    double noise;
  };
  for (const Case& c : {Case{10000.0, 256, 0.2236}, Case{25600.0, 640, 0.2236}, Case{50000.0, 1280, 0.5}}) {
    std::mt19937 random{7};
    std::uniform_real_distribution<double> hz{300.0, 0.3 * c.rate_hz}, any{0.0, kTwoPi}, off{-30.0, 30.0};
    double squares = 0.0;
    constexpr int kCases = 400;
    for (int i = 0; i < kCases; ++i) {
      const Line line{hz(random), 1.0, 0.0, any(random)};
      const auto samples = window(line, c.noise, c.rate_hz, c.length, random);
      const Tone tone = analyse_tone(samples, c.rate_hz, line.frequency_hz + off(random));
      squares += std::pow(tone.frequency_hz - line.frequency_hz, 2);
    }
    EXPECT_LT(std::sqrt(squares / kCases), 2.3 * cramer_rao_hz(1.0, c.noise, c.rate_hz, c.length)) << c.rate_hz;
  }
}

TEST(AnalyseTone, TellsGrowthFromDecay) {
  std::mt19937 random{3};
  std::uniform_real_distribution<double> hz{300.0, 2000.0}, any{0.0, kTwoPi};
  for (int i = 0; i < 200; ++i) {
    for (const double growth : {-60.0, -30.0, 30.0, 60.0}) {
      const Line line{hz(random), 1.0, growth, any(random)};
      const Tone tone = analyse_tone(window(line, 0.02, 25600.0, 640, random), 25600.0, line.frequency_hz + 10.0);
      EXPECT_NEAR(tone.growth_per_s, growth, 15.0);
      EXPECT_EQ(tone.rise > 1.0, growth > 0.0);
    }
  }
}

TEST(AnalyseTone, GivesTheAmplitude) {
  std::mt19937 random{3};
  for (const double hz : {310.0, 733.3, 1499.0, 4000.0}) {
    const Tone tone = analyse_tone(window({hz, 3.0}, 0.0, 25600.0, 640, random), 25600.0, hz + 8.0);
    EXPECT_NEAR(tone.amplitude, 3.0, 0.35) << hz;
    EXPECT_NEAR(tone.steadiness, 1.0, 0.1) << hz;
  }
}

TEST(AnalyseTone, SeesThatAKnockFades) {
  std::mt19937 random{5};
  for (const double since_s : {0.008, 0.012, 0.016, 0.02}) {
    auto samples = window({700.0, 0.0}, 0.02, 25600.0, 640, random);
    const auto start = static_cast<int>(640 - since_s * 25600.0);
    for (int n = start; n < 640; ++n) {
      const double t = (n - start) / 25600.0;
      samples[static_cast<std::size_t>(n)] +=
          static_cast<float>(5.0 * std::exp(-0.03 * kTwoPi * 700.0 * t) * std::sin(kTwoPi * 700.0 * t));
    }
    const Tone tone = analyse_tone(samples, 25600.0, 700.0);
    EXPECT_TRUE(tone.rise < 0.8 || tone.steadiness < 0.15) << since_s << ' ' << tone.rise << ' ' << tone.steadiness;
  }
}

TEST(AnalyseTone, GivesNothingOfSilence) {
  const std::vector<float> silence(640, 0.0F);
  const Tone tone = analyse_tone(silence, 25600.0, 700.0);
  EXPECT_EQ(tone.amplitude, 0.0);
  EXPECT_EQ(tone.frequency_hz, 700.0);
}

TEST(Recurrence, IsThePhaseThatALineTurnsInARevolution) {
  std::mt19937 random{9};
  for (const double spindle_hz : {41.7, 55.5, 100.0, 150.0, 300.0}) {
    for (const double orders : {5.0, 5.2, 6.45, 7.5, 8.7, 9.0}) {
      const double hz = orders * spindle_hz;
      const auto samples = window({hz, 1.0, 20.0}, 0.02, 25600.0, 2560, random);
      const Recurrence turned = recurrence(samples, 640, 25600.0, hz, 1.0 / spindle_hz);
      EXPECT_NEAR(std::remainder(turned.cycles - orders, 1.0), 0.0, 0.01) << spindle_hz << ' ' << orders;
      EXPECT_NEAR(turned.before, std::exp(-20.0 / spindle_hz), 0.05);
    }
  }
}

TEST(Recurrence, IsNoneForOrdersThatRunTogetherInTheWindow) {
  std::mt19937 random{9};
  constexpr double kSpindle_hz = 30.0;
  std::vector<float> samples(2560, 0.0F);
  for (int order = 15; order <= 25; ++order) {
    const auto part = window({order * kSpindle_hz, 1.0, 0.0, 1.7 * order * order}, 0.0, 25600.0, 2560, random);
    for (std::size_t n = 0; n < part.size(); ++n) samples[n] += part[n];
  }
  for (double hz = 500.0; hz < 700.0; hz += 7.0) {
    EXPECT_NEAR(recurrence(samples, 640, 25600.0, hz, 1.0 / kSpindle_hz).cycles, 0.0, 0.02) << hz;
  }
}

TEST(HannPeakOffset, IsExactForALoneLine) {
  for (double offset = -0.5; offset <= 0.5; offset += 0.1) {
    const auto response = [](double bins) {  // Hann window, main lobe
      if (std::abs(bins) < 1e-9) return 1.0;
      if (std::abs(std::abs(bins) - 1.0) < 1e-9) return 0.5;
      return std::abs(std::sin(std::numbers::pi * bins) / (std::numbers::pi * bins * (1.0 - bins * bins)));
    };
    EXPECT_NEAR(hann_peak_offset(response(-1.0 - offset), response(-offset), response(1.0 - offset)), offset, 1e-9);
  }
}

}  // namespace
}  // namespace stillcut
