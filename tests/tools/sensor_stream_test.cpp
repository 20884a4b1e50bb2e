#include "tools/sensor_stream.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace stillcut {
namespace {

constexpr std::int64_t kFirst_ns = 1'700'000'000'000'000'000;

// Ten samples a block, as the usual frame holds them.
class Sender {
 public:
  explicit Sender(double rate_hz, double true_rate_hz = 0.0)
      : rate_hz_{rate_hz}, true_rate_hz_{true_rate_hz > 0.0 ? true_rate_hz : rate_hz} {}

  template <class Signal>
  void send(SensorStream& stream, int blocks, Signal&& signal, std::uint32_t lost_before = 0) {
    for (int b = 0; b < blocks; ++b) {
      if (b == 0) sample_ += std::int64_t{lost_before} * 10;
      SampleBlock block;
      block.axes_present = 0b011;
      block.samples = 10;
      block.frames_lost = b == 0 ? lost_before : 0;
      for (std::size_t i = 0; i < 10; ++i, ++sample_) {
        const double t = static_cast<double>(sample_) / rate_hz_;
        block.acceleration[0][i] = static_cast<float>(signal(t));
        block.acceleration[1][i] = 9.81F;
      }
      block.stamp_ns = kFirst_ns + static_cast<std::int64_t>(1e9 * static_cast<double>(sample_ - 1) / true_rate_hz_);
      stream.add(block);
    }
  }

 private:
  double rate_hz_, true_rate_hz_;
  std::int64_t sample_ = 0;
};

TEST(SensorStream, ALineShowsItsAmplitudeAndFrequencyWhateverTheyAre) {
  std::mt19937 random{3};
  for (int round = 0; round < 20; ++round) {
    const double rate_hz = round % 2 == 0 ? 25600.0 : 10000.0;
    const double hz = std::uniform_real_distribution{50.0, 0.45 * std::min(rate_hz, 10000.0)}(random);
    const double level_db = std::uniform_real_distribution{-40.0, 40.0}(random);
    SensorStream stream{0, rate_hz, 2};
    EXPECT_TRUE(stream.spectrum(50.0).levels.empty());
    Sender sender{rate_hz};
    const double amplitude = std::pow(10.0, level_db / 20.0);
    sender.send(stream, 600, [&](double t) { return amplitude * std::sin(2.0 * std::numbers::pi * hz * t); });
    const SpectrumReport report = stream.spectrum(50.0);
    ASSERT_FALSE(report.levels.empty());
    EXPECT_LE(report.levels.size(), SpectrumReport::kMaxBins);
    const auto loudest = std::max_element(report.levels.begin(), report.levels.end());
    const auto bin = static_cast<double>(loudest - report.levels.begin());
    EXPECT_NEAR((bin + 0.5) * report.bin_hz, hz, 1.6 * report.bin_hz);
    // Between two bins a Hann window shows 1.4 dB less; half a step is rounding.
    EXPECT_LE(report.low_db + report.step_db * *loudest, level_db + 0.3);
    EXPECT_GE(report.low_db + report.step_db * *loudest, level_db - 1.8);
  }
}

// A sensor that falls silent in chatter must not go on to chatter in the picture.
TEST(SensorStream, ASensorThatIsSilentShowsNoSpectrumAgain) {
  SensorStream stream{0, 25600.0, 2};
  Sender sender{25600.0};
  const auto noise = [](double t) { return std::sin(4000.0 * t); };
  sender.send(stream, 600, noise);
  EXPECT_FALSE(stream.spectrum(50.0).levels.empty());
  EXPECT_TRUE(stream.spectrum(50.0).levels.empty());
  sender.send(stream, 1, noise);
  EXPECT_FALSE(stream.spectrum(50.0).levels.empty());
}

TEST(SensorStream, ThinnedSamplesKeepWhatIsSlowAndStandAtItsTime) {
  SensorStream stream{0, 25600.0, 2};
  Sender sender{25600.0};
  const double slow_hz = 11.0;
  const auto signal = [&](double t) {
    return 2.0 * std::sin(2.0 * std::numbers::pi * slow_hz * t) + 30.0 * std::sin(2.0 * std::numbers::pi * 790.0 * t);
  };
  sender.send(stream, 200, signal);
  (void)stream.take_vibration();
  for (int round = 0; round < 20; ++round) {
    sender.send(stream, 128, signal);  // 50 ms
    const VibrationReport report = stream.take_vibration();
    ASSERT_EQ(report.samples.size(), 10U);
    for (std::size_t i = 0; i < report.samples.size(); ++i) {
      const double age_s = static_cast<double>(report.samples.size() - 1 - i) / report.rate_hz;
      const double t = 1e-9 * static_cast<double>(report.stamp_ns - kFirst_ns) - age_s;
      EXPECT_NEAR(report.samples[i][0], 2.0 * std::sin(2.0 * std::numbers::pi * slow_hz * t), 0.08);
      EXPECT_NEAR(report.samples[i][1], 9.81, 1e-4);
      EXPECT_TRUE(std::isnan(report.samples[i][2])) << "not measured";
    }
  }
}

TEST(SensorStream, TheRateIsMeasuredAndLostFramesDoNotBendIt) {
  SensorStream stream{0, 25600.0, 2};
  Sender sender{25600.0, 25600.0 * 1.001};
  const auto silent = [](double) { return 0.0; };
  sender.send(stream, 1000, silent);
  EXPECT_TRUE(std::isnan(stream.health().rate_hz)) << "half a second is too short to tell";
  sender.send(stream, 30000, silent);
  sender.send(stream, 30000, silent, 7);
  EXPECT_NEAR(stream.health().rate_hz, 25625.6, 0.5);
  EXPECT_EQ(stream.health().lost, 7);
  EXPECT_EQ(stream.health().gaps, 1);
}

TEST(SensorStream, SamplesThatCannotBeTrueAreCounted) {
  SensorStream stream{0, 25600.0, 2};
  SampleBlock block;
  block.axes_present = 1;
  block.samples = 10;
  block.stamp_ns = kFirst_ns;
  block.full_scale[0] = 0b1011;
  block.acceleration[0][5] = std::numeric_limits<float>::quiet_NaN();
  stream.add(block);
  EXPECT_EQ(stream.health().saturated, 3);
  EXPECT_EQ(stream.health().not_finite, 1);
}

}  // namespace
}  // namespace stillcut
