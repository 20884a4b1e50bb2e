#include "dsp/sensor_path.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace stillcut {
namespace {

constexpr double kRadiansATurn = 2.0 * std::numbers::pi;
constexpr double kPathRate_hz = 10000.0;

// A sensor of one axis on a spindle; what it feels is amplitude(t) times a wave of the tooth passing and a little
// noise.
class SpindlePath {
 public:
  explicit SpindlePath(double spindle_hz, int teeth = 2) : spindle_hz_{spindle_hz}, teeth_{teeth} {}

  // A wave of teeth that are in the cut a tenth of the time: nearly all power in short pulses.
  template <typename Amplitude, typename Each>
  void hear(double to_s, Amplitude&& amplitude, Each&& each) {
    while (static_cast<double>(n_) < to_s * kPathRate_hz) {
      SampleBlock block;
      block.axes_present = 1;
      block.samples = 10;
      for (int i = 0; i < 10; ++i, ++n_) {
        const double t = static_cast<double>(n_) / kPathRate_hz, turned = spindle_hz_ * teeth_ * t;
        const double in_tooth = turned - std::floor(turned);
        const double pulse = in_tooth < 0.2 ? std::sin(kRadiansATurn * in_tooth / 0.2) : 0.0;
        block.acceleration[0][i] = static_cast<float>(amplitude(t) * (10.0 * pulse + 0.3 * normal_(random_)));
      }
      for (int i = 0; i < block.samples;) {
        i = path.process(block, i, kRadiansATurn * spindle_hz_);
        if (path.hop_complete()) each(static_cast<double>(n_) / kPathRate_hz);
      }
    }
  }

  SensorPath path{{kPathRate_hz, 1}, LineWatchSettings{}};

 private:
  double spindle_hz_;
  int teeth_;
  long n_ = 0;
  std::mt19937 random_{1};
  std::normal_distribution<double> normal_;
};

TEST(SensorPath, CallsStrongToothPassingNeitherARiseNorAFall) {
  for (const double spindle_hz : {17.3, 33.0, 100.0, 250.0}) {
    SpindlePath p{spindle_hz};
    double rise = 1.0, fall = 1.0;
    p.hear(
        1.2, [](double) { return 1.0; },
        [&](double t) {
          if (t < 0.5) return;
          rise = std::max(rise, p.path.rise());
          fall = std::max(fall, p.path.fall());
        });
    EXPECT_LT(rise, 1.6) << spindle_hz;
    EXPECT_LT(fall, 1.6) << spindle_hz;
  }
}

// `factor` on the amplitude from 0.7 s on.
void expect_step(double factor) {
  SpindlePath p{100.0};
  double rise = 1.0, fall = 1.0, rise_later = 1.0, fall_later = 1.0;
  p.hear(
      1.4, [=](double t) { return t < 0.7 ? 1.0 : factor; },
      [&](double t) {
        if (t < 0.5) return;
        double& most_rise = t < 1.1 ? rise : rise_later;
        double& most_fall = t < 1.1 ? fall : fall_later;
        most_rise = std::max(most_rise, p.path.rise());
        most_fall = std::max(most_fall, p.path.fall());
      });
  const double power = factor * factor;
  EXPECT_NEAR((power > 1.0 ? rise : fall) / std::max(power, 1.0 / power), 1.2, 0.25) << factor;
  EXPECT_LT(power > 1.0 ? fall : rise, 1.5) << factor;
  EXPECT_LT(rise_later, 1.5) << factor;  // a quarter of a second later it is forgotten
  EXPECT_LT(fall_later, 1.5) << factor;
}

TEST(SensorPath, TellsByHowMuchPowerRises) {
  for (const double factor : {1.5, 2.0, 5.0}) expect_step(factor);
}

TEST(SensorPath, TellsByHowMuchPowerFalls) {
  for (const double factor : {0.7, 0.5, 0.2}) expect_step(factor);
}

TEST(SensorPath, TellsOfAToolThatLeavesTheCutForAMomentBoth) {
  SpindlePath p{100.0};
  p.hear(
      0.75, [](double t) { return t > 0.65 && t < 0.7 ? 0.2 : 1.0; }, [](double) {});
  EXPECT_GT(p.path.fall(), 15.0);
  EXPECT_GT(p.path.rise(), 15.0);
}

}  // namespace
}  // namespace stillcut
