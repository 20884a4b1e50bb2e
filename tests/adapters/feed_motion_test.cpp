#include "adapters/feed_motion.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace stillcut {
namespace {

TEST(FeedMotion, MeasuresRateAndDirectionAtEveryCycleTime) {
  for (const std::int64_t cycle_us : {4'000, 12'000, 50'000, 100'000}) {
    FeedMotion motion;
    for (std::int64_t i = 0; i < 100; ++i) {
      const double t = static_cast<double>(i * cycle_us) * 1e-6;
      motion.add(i * cycle_us, {0.03 * t, 0.04 * t, 0.12 * t});
    }
    EXPECT_NEAR(motion.rate_m_per_s(), 0.13, 1e-12) << cycle_us;
    EXPECT_NEAR(motion.direction(), std::atan2(4, 3), 1e-12) << cycle_us;
  }
}

TEST(FeedMotion, IsNotShakenByTheRoundingOfPositions) {
  FeedMotion motion;
  for (std::int64_t i = 0; i < 200; ++i) {  // 25 mm/s, told to 0.01 mm
    motion.add(4000 * i, {std::round(0.025 * 0.004 * static_cast<double>(i) * 1e5) * 1e-5, 0.0, 0.0});
    if (i > 20) {
      ASSERT_NEAR(motion.rate_m_per_s(), 0.025, 0.00025);
    }
  }
}

TEST(FeedMotion, KeepsTheDirectionWhileTheToolStands) {
  FeedMotion motion;
  motion.assume(0.5);
  motion.add(0, {0, 0, 0});
  EXPECT_EQ(motion.direction(), 0.5);
  for (std::int64_t i = 1; i < 50; ++i) motion.add(4000 * i, {0.0, -1e-4 * static_cast<double>(i), 0.0});
  EXPECT_NEAR(motion.direction(), -std::acos(0.0), 1e-12);
  for (std::int64_t i = 50; i < 100; ++i) motion.add(4000 * i, {0.0, -4.9e-3, 0.0});
  EXPECT_EQ(motion.rate_m_per_s(), 0.0);
  EXPECT_NEAR(motion.direction(), -std::acos(0.0), 1e-12);
}

TEST(FeedMotion, StartsAnewWhereTheClockJumps) {
  FeedMotion motion;
  motion.add(1'000'000, {0, 0, 0});
  motion.add(900'000, {1, 0, 0});
  EXPECT_EQ(motion.rate_m_per_s(), 0.0);
  motion.add(5'000'000, {2, 0, 0});
  EXPECT_EQ(motion.rate_m_per_s(), 0.0);
}

}  // namespace
}  // namespace stillcut
