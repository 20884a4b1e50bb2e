#include "dsp/lanes_fft.hpp"

#include <gtest/gtest.h>

#include <random>
#include <stdexcept>
#include <vector>

#include "dsp/fft.hpp"

namespace stillcut {
namespace {

TEST(LanesFft, GivesOnEveryLaneThePowerOfItsOwnSignal) {
  std::mt19937 random{1};
  std::normal_distribution<float> normal;
  for (const int length : {4, 6, 8, 10, 24, 40, 250, 256, 450, 640, 1280}) {
    LanesFft lanes{length};
    RealFft single{length};
    std::vector<std::vector<float>> signals(Lanes::kCount, std::vector<float>(length));
    for (auto& signal : signals) {
      for (float& x : signal) x = normal(random);
    }
    const auto at = [&](int n) { return Lanes{signals[0][n], signals[1][n], signals[2][n], signals[3][n]}; };
    for (int n = 0; n < length / 2; ++n) lanes.pairs()[n] = {at(2 * n), at(2 * n + 1)};
    std::vector<Lanes> power(lanes.bins());
    lanes.power(0, lanes.bins() - 1, power);
    for (int lane = 0; lane < Lanes::kCount; ++lane) {
      std::vector<std::complex<float>> spectrum(single.bins());
      single.transform(signals[lane], spectrum);
      for (int k = 0; k < single.bins(); ++k) {
        EXPECT_NEAR(power[k][lane], std::norm(spectrum[k]), 2e-5F * length) << length << ' ' << lane << ' ' << k;
      }
    }
  }
}

TEST(LanesFft, RefusesLengthsThatItCannotTransform) {
  for (const int length : {0, 2, 7, 14, 15, 22}) EXPECT_THROW(LanesFft{length}, std::invalid_argument) << length;
}

}  // namespace
}  // namespace stillcut
