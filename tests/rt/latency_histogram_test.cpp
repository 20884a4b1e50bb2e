#include "rt/latency_histogram.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <thread>
#include <vector>

namespace stillcut {
namespace {

TEST(LatencyHistogram, IsZeroWhenEmpty) {
  const LatencyHistogram histogram;
  const LatencySummary summary = histogram.summary();
  EXPECT_EQ(summary.count, 0U);
  EXPECT_EQ(summary.p50_ns, 0);
  EXPECT_EQ(summary.max_ns, 0);
}

TEST(LatencyHistogram, PercentilesAreNeverTooLowAndAtMostOneBinTooHigh) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    std::mt19937_64 random{seed};
    std::lognormal_distribution<double> duration{1.0 + static_cast<double>(seed), 1.5};
    LatencyHistogram histogram;
    std::vector<std::int64_t> sorted;
    for (int i = 0; i < 30'000; ++i) {
      sorted.push_back(static_cast<std::int64_t>(std::min(duration(random), 1e12)));
      histogram.record(sorted.back());
    }
    std::sort(sorted.begin(), sorted.end());
    for (double fraction : {0.0, 0.01, 0.5, 0.99, 0.999, 0.9999, 1.0}) {
      const double rank = std::max(1.0, std::ceil(fraction * static_cast<double>(sorted.size())));
      const std::int64_t exact = sorted[static_cast<std::size_t>(rank) - 1];
      const std::int64_t read = histogram.percentile_ns(fraction);
      ASSERT_GE(read, exact) << "seed " << seed << " fraction " << fraction;
      ASSERT_LE(read, exact + exact / 32) << "seed " << seed << " fraction " << fraction;
    }
    EXPECT_EQ(histogram.max_ns(), sorted.back());
    EXPECT_EQ(histogram.count(), sorted.size());
  }
}

TEST(LatencyHistogram, HasNoGapBetweenItsBins) {
  // One value alone: the percentile is limited by the maximum, hence exact, wherever its bin lies.
  for (int bit = 0; bit < 62; ++bit) {
    for (std::int64_t offset : {-1, 0, 1}) {
      const std::int64_t value = (std::int64_t{1} << bit) + offset;
      LatencyHistogram histogram;
      histogram.record(value);
      EXPECT_EQ(histogram.percentile_ns(0.5), value);
    }
  }
}

TEST(LatencyHistogram, TakesAnyValue) {
  LatencyHistogram histogram;
  for (std::int64_t value : {INT64_MIN, std::int64_t{-1}, std::int64_t{0}, INT64_MAX}) histogram.record(value);
  EXPECT_EQ(histogram.count(), 4U);
  EXPECT_EQ(histogram.percentile_ns(0.75), 0);
  EXPECT_EQ(histogram.percentile_ns(1.0), INT64_MAX);
}

TEST(LatencyHistogram, CanBeReadWhileItRecords) {
  LatencyHistogram histogram;
  constexpr std::uint64_t kValues = 200'000;
  std::thread writer{[&] {
    for (std::uint64_t i = 0; i < kValues; ++i) histogram.record(1000 + static_cast<std::int64_t>(i % 1000));
  }};
  std::uint64_t last = 0;
  while (last < kValues) {
    const std::uint64_t count = histogram.count();
    ASSERT_GE(count, last);
    last = count;
    const std::int64_t median = histogram.percentile_ns(0.5);
    ASSERT_TRUE(count == 0 || (median >= 1000 && median < 2000)) << median;
  }
  writer.join();
  EXPECT_EQ(histogram.max_ns(), 1999);
}

}  // namespace
}  // namespace stillcut
