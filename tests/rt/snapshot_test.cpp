#include "rt/snapshot.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <random>
#include <thread>

namespace stillcut {
namespace {

// Large enough that a copy takes a while; every word follows from the sequence number.
struct Diagram {
  std::uint64_t sequence = 0;
  std::array<std::uint64_t, 127> words{};

  static Diagram numbered(std::uint64_t sequence) {
    Diagram diagram{sequence, {}};
    for (std::uint64_t i = 0; i < diagram.words.size(); ++i) diagram.words[i] = (sequence ^ i) * 0x9E3779B97F4A7C15U;
    return diagram;
  }
  [[nodiscard]] bool whole() const { return words == numbered(sequence).words; }
};

TEST(Snapshot, ShowsTheInitialValueUntilTheFirstPublish) {
  Snapshot<int> snapshot{7};
  EXPECT_EQ(snapshot.value(), 7);
  EXPECT_FALSE(snapshot.update());
  EXPECT_EQ(snapshot.value(), 7);
}

TEST(Snapshot, ShowsANewValueOnlyAfterUpdateAndSaysSoOnce) {
  Snapshot<int> snapshot{1};
  snapshot.publish(2);
  EXPECT_EQ(snapshot.value(), 1);
  EXPECT_TRUE(snapshot.update());
  EXPECT_EQ(snapshot.value(), 2);
  EXPECT_FALSE(snapshot.update());
  EXPECT_EQ(snapshot.value(), 2);
}

TEST(Snapshot, HoldsTheNewestOfAnyOrderOfCalls) {
  std::mt19937_64 random{1};
  Snapshot<std::uint64_t> snapshot{0};
  std::uint64_t published = 0, shown = 0;
  for (int step = 0; step < 100'000; ++step) {
    if (random() % 2 == 0) {
      snapshot.publish(++published);
    } else {
      ASSERT_EQ(snapshot.update(), shown != published);
      shown = published;
    }
    ASSERT_EQ(snapshot.value(), shown);
  }
}

TEST(Snapshot, GivesWholeValuesInRisingOrderUnderAConcurrentWriter) {
  constexpr std::uint64_t kValues = 100'000;
  Snapshot<Diagram> snapshot{Diagram::numbered(0)};
  std::thread writer{[&] {
    for (std::uint64_t i = 1; i <= kValues; ++i) {
      snapshot.publish(Diagram::numbered(i));
      if (i % 128 == 0) std::this_thread::yield();
    }
  }};
  std::uint64_t last = 0, not_rising = 0, torn = 0, changed_unasked = 0;
  while (last != kValues) {  // the last value published must arrive
    const bool newer = snapshot.update();
    const std::uint64_t sequence = snapshot.value().sequence;
    if (newer) not_rising += sequence > last ? 0 : 1;
    if (!newer) {
      changed_unasked += sequence == last ? 0 : 1;
      std::this_thread::yield();
    }
    torn += snapshot.value().whole() ? 0 : 1;
    last = sequence;
  }
  writer.join();
  EXPECT_EQ(not_rising, 0U);
  EXPECT_EQ(torn, 0U);
  EXPECT_EQ(changed_unasked, 0U);
  EXPECT_FALSE(snapshot.update());
}

}  // namespace
}  // namespace stillcut
