#include "tools/channel_rates.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <random>
#include <vector>

namespace stillcut {
namespace {

using ::testing::HasSubstr;

// Against the sums written out.
TEST(ChannelRates, IntervalsAreSummedUpRightly) {
  std::mt19937 random{2};
  for (int round = 0; round < 50; ++round) {
    ChannelRate rate;
    std::vector<double> intervals;
    std::int64_t now_us = 1'700'000'000'000'000, bytes = 0;
    rate.add(now_us, 0);
    for (unsigned count = 2 + random() % 200; count > 0; --count) {
      const auto interval_us = static_cast<std::int64_t>(random() % 100'000);
      const std::size_t size = random() % 1000;
      now_us += interval_us;
      bytes += static_cast<std::int64_t>(size);
      intervals.push_back(static_cast<double>(interval_us) * 1e-6);
      rate.add(now_us, size);
    }
    const auto count = static_cast<double>(intervals.size());
    const double mean = std::accumulate(intervals.begin(), intervals.end(), 0.0) / count;
    double squares = 0.0;
    for (const double interval : intervals) squares += (interval - mean) * (interval - mean);
    const IntervalSummary all = rate.all();
    EXPECT_EQ(all.messages, static_cast<std::int64_t>(intervals.size()) + 1);
    EXPECT_EQ(all.bytes, bytes);
    EXPECT_NEAR(all.mean, mean, 1e-12);
    EXPECT_NEAR(all.deviation, std::sqrt(squares / (count - 1.0)), 1e-9);
    EXPECT_EQ(all.least, *std::min_element(intervals.begin(), intervals.end()));
    EXPECT_EQ(all.most, *std::max_element(intervals.begin(), intervals.end()));
  }
}

TEST(ChannelRates, LostMessagesOfAnEvenChannelAreGapsAndUnevenOnesHaveNone) {
  ChannelRate even;
  for (int i = 0; i < 100; ++i)
    if (i != 40 && i != 41 && i != 70 && i != 71 && i != 72) even.add(i * 10'000 + i % 3, 10);
  EXPECT_EQ(even.gaps(), 2);
  ChannelRate uneven;
  for (int i = 0; i < 100; ++i) uneven.add(i / 4 * 1'000'000 + i % 4 * 1000, 10);
  EXPECT_EQ(uneven.gaps(), 0);
  ChannelRate first;
  first.add(0, 1);
  first.add(5'000'000, 1);
  EXPECT_EQ(first.gaps(), 0) << "nobody knows yet how often it comes";
}

TEST(ChannelRates, AClockThatIsSetBackIsCountedAndSpoilsNothing) {
  ChannelRate rate;
  for (const int ms : {1000, 1010, 500, 510, 520}) rate.add(ms * 1000, 1);
  EXPECT_EQ(rate.back(), 1);
  EXPECT_EQ(rate.all().messages, 5);
  EXPECT_NEAR(rate.all().mean, 0.010, 1e-9);
}

TEST(ChannelRates, APeriodCountsItsOwnAndNamesHaveABound) {
  ChannelRates rates;
  for (int i = 0; i < 10; ++i) rates.add("A", i * 100'000, 50);
  rates.begin_period();
  for (int i = 10; i < 15; ++i) rates.add("A", i * 100'000, 50);
  EXPECT_EQ(rates.channels().at("A").period().messages, 5);
  EXPECT_EQ(rates.channels().at("A").all().messages, 15);
  EXPECT_THAT(rates_text(rates, 0.5), HasSubstr("10.00"));  // five in half a second
  for (int i = 0; i < 2000; ++i) rates.add("N" + std::to_string(i), 0, 1);
  EXPECT_EQ(rates.channels().size(), ChannelRates::kMostChannels);
  EXPECT_EQ(rates.beyond(), 1001);
  EXPECT_THAT(rates_text(rates, 1.0), HasSubstr("1001 messages on further channels"));
  EXPECT_THAT(rates_text(ChannelRates{}, 1.0), HasSubstr("nothing was heard yet"));
}

}  // namespace
}  // namespace stillcut
