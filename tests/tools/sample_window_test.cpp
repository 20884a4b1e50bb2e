// What a window holds of a sensor's samples, against a list of every sample and its time.
#include "tools/sample_window.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "dsp/numbers.hpp"

namespace stillcut {
namespace {

constexpr std::int64_t kOrigin_ns = 1'700'000'000'000'000'000;
constexpr float kLost = -1.0F;

// A sensor that numbers its samples, frames of which are lost by chance.
struct NumberedSensor {
  double rate_hz;
  int block;
  bool counts;
  std::vector<SampleBlock> blocks;
  std::vector<float> sent;  // by number; kLost: in a frame that was lost

  NumberedSensor(std::mt19937& random, bool with_counter) : counts{with_counter} {
    rate_hz = std::array{1000.0, 10000.0, 25600.0}.at(random() % 3);
    block = static_cast<int>(1 + random() % 20);
    const auto frames = 20 + random() % 100;
    std::uint32_t lost = 0;
    for (std::uint32_t f = 0; f < frames; ++f) {
      // Without a counter only a gap of more than 50 ms tells itself.
      const bool is_lost = f > 0 && (counts ? random() % 6 == 0 : lost > 0 && lost * block / rate_hz < 0.06);
      const bool begins_gap = !counts && f > 0 && lost == 0 && random() % 20 == 0;
      SampleBlock now;
      const auto last = static_cast<std::int64_t>(f + 1) * block - 1;
      now.stamp_ns = kOrigin_ns + std::llround(static_cast<double>(last) / rate_hz * 1e9);
      now.axes_present = 0b101;
      now.samples = static_cast<std::uint8_t>(block);
      for (int i = 0; i < block; ++i) {
        const auto number = static_cast<float>(sent.size());
        now.acceleration[0].at(static_cast<std::size_t>(i)) = number;
        now.acceleration[2].at(static_cast<std::size_t>(i)) = 0.5F * number;
        sent.push_back(is_lost || begins_gap ? kLost : number);
      }
      if (is_lost || begins_gap) {
        ++lost;
        continue;
      }
      now.frames_lost = counts ? lost : 0;
      lost = 0;
      blocks.push_back(now);
    }
    while (sent.back() == kLost) sent.pop_back();  // nobody knows of these
  }
};

std::vector<AccelerometerSettings> settings_of(double rate_hz) {
  std::vector<AccelerometerSettings> settings(1);
  settings[0].sample_rate_hz = rate_hz;
  return settings;
}

TEST(SampleWindow, HoldsEverySampleOfItsTimeInItsPlaceAndNoOther) {
  std::mt19937 random{7};
  for (int trial = 0; trial < 2000; ++trial) {
    const NumberedSensor sensor{random, trial % 2 == 0};
    const double end_s = static_cast<double>(sensor.sent.size()) / sensor.rate_hz;
    std::uniform_real_distribution<double> time{-0.1 * end_s, 1.1 * end_s};
    double from_s = time(random), to_s = time(random);
    if (from_s > to_s) std::swap(from_s, to_s);
    if (trial % 5 == 0) from_s = std::round(std::max(0.0, from_s) * sensor.rate_hz) / sensor.rate_hz;  // a sample's own
    const double same = 1e-4 / sensor.rate_hz;
    std::vector<float> expected;
    for (std::size_t i = 0; i < sensor.sent.size(); ++i) {
      const double at = static_cast<double>(i) / sensor.rate_hz;
      if (at >= from_s - same && at < to_s - same) expected.push_back(sensor.sent[i]);
    }
    const auto settings = settings_of(sensor.rate_hz);
    SampleWindow window{settings, from_s, to_s};
    std::vector<float> held;
    for (const SampleBlock& block : sensor.blocks) {
      const auto stretch = window.cut(block, kOrigin_ns);
      if (!stretch) continue;
      if (held.empty()) {
        EXPECT_GE(stretch->begin_s, from_s - 1e-8);
      }
      held.insert(held.end(), static_cast<std::size_t>(stretch->missing), kLost);
      ASSERT_EQ(stretch->axis[0].size(), static_cast<std::size_t>(stretch->samples));
      ASSERT_EQ(stretch->axis[1].data(), nullptr) << "an axis that is not measured";
      for (std::size_t i = 0; i < stretch->axis[0].size(); ++i) {
        const auto number = static_cast<double>(stretch->axis[0][i]);
        const double at = stretch->begin_s + static_cast<double>(stretch->missing) * stretch->step_s;
        EXPECT_NEAR(at + static_cast<double>(i) * stretch->step_s, number / sensor.rate_hz, 2e-9);
        EXPECT_EQ(stretch->axis[2][i], 0.5F * stretch->axis[0][i]);
      }
      held.insert(held.end(), stretch->axis[0].begin(), stretch->axis[0].end());
    }
    ASSERT_EQ(held, expected) << "trial " << trial << ", from " << from_s << " to " << to_s;
  }
}

TEST(SampleWindow, WithoutEndsHoldsAll) {
  std::mt19937 random{1};
  const NumberedSensor sensor{random, true};
  const auto settings = settings_of(sensor.rate_hz);
  SampleWindow window{settings, 0.0, kInfinity};
  std::int64_t held = 0;
  for (const SampleBlock& block : sensor.blocks) {
    const auto stretch = window.cut(block, kOrigin_ns);
    ASSERT_TRUE(stretch);
    held += stretch->missing + stretch->samples;
  }
  EXPECT_EQ(held, std::ssize(sensor.sent));
}

}  // namespace
}  // namespace stillcut
