#include "dsp/hann_line.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <random>
#include <vector>

namespace stillcut {
namespace {

TEST(HannLine, GivesAmplitudeAndPhaseOfALineAnywhereBetweenTheBins) {
  constexpr int kLength = 640;
  constexpr double kTurn = 2.0 * std::numbers::pi;
  std::mt19937 random{5};
  std::uniform_real_distribution<double> share{0.0, 1.0};
  AxesFft fft{kLength};
  std::vector<Lanes> input(kLength);
  std::vector<ComplexLanes> spectrum(kLength / 2 + 1);
  for (int i = 0; i < 200; ++i) {
    const double at_bin = 4.0 + (kLength / 2 - 8.0) * share(random), amplitude = 0.1 + share(random),
                 phase = kTurn * share(random);
    for (int n = 0; n < kLength; ++n) {
      const double hann = 0.5 - 0.5 * std::cos(kTurn * n / kLength);
      const double angle = kTurn * at_bin * (n - kLength / 2) / kLength + phase;  // phase: in the middle
      input[static_cast<std::size_t>(n)] = Lanes{static_cast<float>(hann * amplitude * std::cos(angle)),
                                                 static_cast<float>(hann * std::cos(angle)), 0.0F, 0.0F};
    }
    fft.transform(input, spectrum);
    const ComplexLanes line = HannLine{at_bin, kLength}.in(spectrum);
    const std::complex<double> first{line.re[0], line.im[0]}, second{line.re[1], line.im[1]};
    EXPECT_LT(std::abs(first - std::polar(amplitude, phase)), 0.01 * amplitude) << at_bin;
    EXPECT_LT(std::abs(second - std::polar(1.0, phase)), 0.01) << at_bin;
    EXPECT_EQ(line.re[2], 0.0F);
  }
}

}  // namespace
}  // namespace stillcut
