#include "dsp/sample_clock.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace stillcut {
namespace {

constexpr std::int64_t kStart_ns = 1'700'000'000'000'000'000;

struct Stream {
  double rate_hz = 25600.0;
  int samples = 10;
  double rate_error = 0.0;  // the sensor's own clock is this much fast

  [[nodiscard]] std::int64_t taken_ns(int block) const {
    return kStart_ns + std::llround(1e9 * block * samples / (rate_hz * (1.0 + rate_error)));
  }
};

TEST(SampleClock, PassesExactStampsThrough) {
  const Stream stream;
  SampleClock clock{stream.rate_hz};
  for (int i = 0; i < 20000; ++i) {
    const auto placed = clock.place(stream.taken_ns(i), stream.samples, 0);
    EXPECT_NEAR(static_cast<double>(placed.stamp_ns - stream.taken_ns(i)), 0.0, 1000.0);
    EXPECT_EQ(placed.samples_lost, 0);
    EXPECT_FALSE(placed.jumped);
  }
}

// Frames that wait for a busy bus keep their order and arrive in clusters.
TEST(SampleClock, FindsTheSampleTimesBehindArrivalsThatComeUpTo30MillisecondsLate) {
  for (const Stream& stream :
       {Stream{25600.0, 10}, Stream{10000.0, 30}, Stream{25600.0, 10, 300e-6}, Stream{25600.0, 10, -300e-6}}) {
    std::mt19937 random{11};
    std::uniform_real_distribution<double> late_ns{0.0, 30e6};
    SampleClock clock{stream.rate_hz};
    std::int64_t released_ns = 0;
    double next_release_ns = 0.0;
    double worst_ns = 0.0;
    for (int i = 0; i < 30000; ++i) {
      const std::int64_t taken_ns = stream.taken_ns(i);
      while (next_release_ns < static_cast<double>(taken_ns - kStart_ns)) next_release_ns += late_ns(random);
      released_ns = std::max<std::int64_t>(taken_ns, kStart_ns + std::llround(next_release_ns));
      const auto placed = clock.place(released_ns, stream.samples, 0);
      if (i * stream.samples > 3.0 * stream.rate_hz) {
        worst_ns = std::max(worst_ns, std::abs(static_cast<double>(placed.stamp_ns - taken_ns)));
      }
    }
    EXPECT_LT(worst_ns, 1e6) << stream.samples << ' ' << stream.rate_error;
  }
}

TEST(SampleClock, CountsLostFramesAndKeepsTime) {
  const Stream stream;
  SampleClock clock{stream.rate_hz};
  std::mt19937 random{2};
  std::uint32_t lost = 0;
  std::int64_t told = 0, dropped = 0;
  for (int i = 0; i < 20000; ++i) {
    if (i > 0 && random() % 50 == 0) {
      ++lost;
      ++dropped;
      continue;
    }
    const auto placed = clock.place(stream.taken_ns(i), stream.samples, lost);
    lost = 0;
    told += placed.samples_lost;
    EXPECT_NEAR(static_cast<double>(placed.stamp_ns - stream.taken_ns(i)), 0.0, 1000.0);
  }
  EXPECT_EQ(told, (dropped - lost) * stream.samples);
}

TEST(SampleClock, StartsAnewAfterALongSilenceAndSaysHowMuchIsMissing) {
  const Stream stream;
  SampleClock clock{stream.rate_hz};
  for (int i = 0; i < 100; ++i) clock.place(stream.taken_ns(i), stream.samples, 0);
  const auto placed = clock.place(stream.taken_ns(100 + 2560), stream.samples, 0);
  EXPECT_TRUE(placed.jumped);
  EXPECT_EQ(placed.samples_lost, 25600);
  EXPECT_EQ(placed.stamp_ns, stream.taken_ns(100 + 2560));
}

TEST(SampleClock, SurvivesAClockThatStepsBackAndACounterThatRunsWild) {
  const Stream stream;
  SampleClock clock{stream.rate_hz};
  for (int i = 0; i < 100; ++i) clock.place(stream.taken_ns(i), stream.samples, 0);
  const auto back = clock.place(stream.taken_ns(99) - 3'600'000'000'000, stream.samples, 0);
  EXPECT_TRUE(back.jumped);
  EXPECT_EQ(back.samples_lost, 0);
  const auto wild = clock.place(back.stamp_ns + 390'625, stream.samples, 0xFFFFFFFFU);
  EXPECT_TRUE(wild.jumped);
  EXPECT_EQ(wild.samples_lost, 0);
}

}  // namespace
}  // namespace stillcut
