#include "dsp/spindle_speed.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace stillcut {
namespace {

constexpr std::int64_t kMs = 1'000'000;

TEST(SpindleSpeed, IsZeroBeforeTheFirstReading) {
  const SpindleSpeed speed;
  EXPECT_FALSE(speed.has_reading());
  EXPECT_EQ(speed.at(5 * kMs), 0.0);
}

TEST(SpindleSpeed, ExtendsARampExactlyForwardAndBack) {
  SpindleSpeed speed;
  for (int i = 0; i <= 10; ++i) speed.add({i * 20 * kMs, 600.0 + 100.0 * 0.02 * i});
  for (int ms = 160; ms <= 240; ++ms) EXPECT_NEAR(speed.at(ms * kMs), 600.0 + 0.1 * ms, 1e-9) << ms;
}

TEST(SpindleSpeed, HoldsAfterALongSilence) {
  SpindleSpeed speed;
  speed.add({0, 600.0});
  speed.add({20 * kMs, 602.0});
  EXPECT_NEAR(speed.at(10'000 * kMs), 602.0 + 0.06 * 100.0, 1e-9);
}

TEST(SpindleSpeed, TakesNoSlopeFromReadingsFarApart) {
  SpindleSpeed speed;
  speed.add({0, 0.0});
  speed.add({400 * kMs, 600.0});
  EXPECT_EQ(speed.at(430 * kMs), 600.0);
}

TEST(SpindleSpeed, IgnoresWhatIsNoNumberAndWhatIsOlder) {
  SpindleSpeed speed;
  speed.add({20 * kMs, 600.0});
  speed.add({30 * kMs, std::numeric_limits<double>::quiet_NaN()});
  speed.add({10 * kMs, 100.0});
  speed.add({20 * kMs, 100.0});
  EXPECT_EQ(speed.at(30 * kMs), 600.0);
  EXPECT_EQ(speed.last_stamp_ns(), 20 * kMs);
}

TEST(SpindleSpeed, IsCertainAtConstantSpeedAndOnAnEvenRamp) {
  SpindleSpeed speed;
  for (int i = 0; i <= 100; ++i) speed.add({i * 20 * kMs, 600.0 + (i > 2 ? 2.0 * (i - 2) : 0.0)});
  EXPECT_LT(speed.uncertainty(), 1e-6);
}

TEST(SpindleSpeed, IsUncertainByWhatAReadingMissed) {
  SpindleSpeed speed;
  for (int i = 0; i <= 10; ++i) speed.add({i * 20 * kMs, 600.0});
  speed.add({220 * kMs, 608.0});
  EXPECT_NEAR(speed.uncertainty(), 8.0, 1e-9);
}

}  // namespace
}  // namespace stillcut
