#include "rt/ring.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <deque>
#include <random>
#include <stdexcept>
#include <thread>

#include "rt/signals.hpp"

namespace stillcut {
namespace {

// An item whose every word follows from its number: a torn copy shows.
struct Item {
  std::array<std::uint64_t, 8> words;

  static Item numbered(std::uint64_t number) {
    Item item;
    for (std::uint64_t i = 0; i < item.words.size(); ++i) item.words[i] = (number + i) * 0x9E3779B97F4A7C15U;
    return item;
  }
  friend bool operator==(const Item&, const Item&) = default;
};

static_assert(sizeof(Ring<Output>) % kCacheLine == 0 && alignof(Ring<Output>) == kCacheLine);

TEST(Ring, RefusesACapacityThatIsNotAPowerOfTwo) {
  for (std::size_t capacity : {0U, 3U, 6U, 1000U}) EXPECT_THROW(Ring<int>{capacity}, std::invalid_argument) << capacity;
  for (std::size_t capacity : {1U, 2U, 1024U}) EXPECT_EQ(Ring<int>{capacity}.capacity(), capacity);
}

TEST(Ring, HoldsExactlyItsCapacityAndCountsWhatItRefuses) {
  Ring<int> ring{4};
  for (int i = 0; i < 4; ++i) EXPECT_TRUE(ring.push(i));
  EXPECT_EQ(ring.size_approx(), 4U);
  EXPECT_FALSE(ring.push(4));
  EXPECT_FALSE(ring.push(5));
  EXPECT_EQ(ring.refused(), 2U);
  int item = -1;
  for (int i = 0; i < 4; ++i) {
    ASSERT_TRUE(ring.pop(item));
    EXPECT_EQ(item, i);
  }
  EXPECT_FALSE(ring.pop(item));
  EXPECT_EQ(item, 3) << "an empty ring leaves the item alone";
}

TEST(Ring, BehavesAsABoundedQueueUnderRandomCalls) {
  for (std::size_t capacity : {1U, 2U, 8U, 64U}) {
    std::mt19937_64 random{capacity};
    Ring<Item> ring{capacity};
    std::deque<Item> queue;
    std::uint64_t refused = 0;
    for (std::uint64_t step = 0; step < 20'000; ++step) {
      // Long stretches of mostly pushing, then mostly popping, so that both ends are met.
      const bool pushing = random() % 8 < ((step / 200) % 2 == 0 ? 6U : 2U);
      if (pushing) {
        const bool fits = queue.size() < capacity;
        ASSERT_EQ(ring.push(Item::numbered(step)), fits);
        if (fits) queue.push_back(Item::numbered(step));
        refused += fits ? 0 : 1;
      } else {
        Item item{};
        ASSERT_EQ(ring.pop(item), !queue.empty());
        if (!queue.empty()) {
          ASSERT_EQ(item, queue.front());
          queue.pop_front();
        }
      }
      ASSERT_EQ(ring.size_approx(), queue.size());
    }
    EXPECT_EQ(ring.refused(), refused);
    EXPECT_GT(refused, 0U);
  }
}

TEST(Ring, DeliversEveryItemInOrderAndWholeAcrossThreads) {
  for (std::size_t capacity : {1U, 2U, 64U, 1024U}) {
    // Each time the ring is full or empty may cost a switch of threads: fewer items for the small ones.
    const std::uint64_t items = std::min<std::uint64_t>(1'000 * capacity, 100'000);
    Ring<Item> ring{capacity};
    std::thread producer{[&] {
      for (std::uint64_t i = 0; i < items; ++i) {
        while (!ring.push(Item::numbered(i))) std::this_thread::yield();
      }
    }};
    std::uint64_t wrong = 0;
    for (std::uint64_t i = 0; i < items; ++i) {
      Item item{};
      while (!ring.pop(item)) std::this_thread::yield();
      wrong += item == Item::numbered(i) ? 0 : 1;
    }
    producer.join();
    Item item{};
    EXPECT_EQ(wrong, 0U) << "capacity " << capacity;
    EXPECT_FALSE(ring.pop(item));
  }
}

TEST(Ring, LosesOnlyWhatItRefusedWhenTheProducerDoesNotWait) {
  constexpr std::uint64_t kItems = 300'000;
  Ring<Item> ring{16};
  std::atomic<bool> done{false};
  std::thread producer{[&] {
    for (std::uint64_t i = 0; i < kItems; ++i) {
      (void)ring.push(Item::numbered(i));
      if (i % 64 == 0) std::this_thread::yield();
    }
    done.store(true, std::memory_order_release);
  }};
  std::uint64_t received = 0, wrong = 0, next = 0;
  for (bool last_round = false;;) {
    for (Item item{}; ring.pop(item); ++received) {
      while (next < kItems && item != Item::numbered(next)) ++next;  // numbers only rise: missing ones are passed over
      wrong += next == kItems ? 1 : 0;
      ++next;
    }
    EXPECT_LE(ring.size_approx(), ring.capacity());
    if (last_round) break;
    last_round = done.load(std::memory_order_acquire);
  }
  producer.join();
  EXPECT_EQ(wrong, 0U);
  EXPECT_EQ(received + ring.refused(), kItems);
}

}  // namespace
}  // namespace stillcut
