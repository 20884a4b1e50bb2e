// Ring and snapshot, several pairs of threads at a time, for the thread sanitizer. More threads than processors, so
// that a thread is taken off in the middle of every method now and then.
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <deque>
#include <thread>
#include <vector>

#ifdef STILLCUT_RELAXED  // the proof that the sanitizer would see it: a header without its releases
#define memory_order_release memory_order_relaxed
#define memory_order_acq_rel memory_order_relaxed
#endif
#include "rt/ring.hpp"
#include "rt/snapshot.hpp"
#undef memory_order_release
#undef memory_order_acq_rel
#include "tests/stress/stress_time.hpp"

namespace stillcut {
namespace {

using test::stress;

// Every word follows from the number.
struct Item {
  std::array<std::uint64_t, 16> words{};

  static Item numbered(std::uint64_t number) {
    Item item;
    for (std::uint64_t i = 0; i < item.words.size(); ++i) item.words[i] = (number ^ i) * 0x9E3779B97F4A7C15U;
    return item;
  }
  [[nodiscard]] bool is(std::uint64_t number) const { return words == numbered(number).words; }
};

constexpr int kBatch = 4096;  // between two looks at the time

void exchange_through(Ring<Item>& ring) {
  std::atomic<bool> done{false};
  std::uint64_t taken = 0;
  std::thread producer{[&] {
    stress([&] {
      for (int i = 0; i < kBatch; ++i) taken += ring.push(Item::numbered(taken)) ? 1 : 0;
    });
    done.store(true);
  }};
  std::thread onlooker{[&] {
    while (!done.load()) {
      ASSERT_LE(ring.size_approx(), ring.capacity());
      (void)ring.refused();
      std::this_thread::yield();
    }
  }};
  std::uint64_t received = 0, wrong = 0;
  for (bool last = false;;) {
    for (Item item; ring.pop(item); ++received) wrong += item.is(received) ? 0 : 1;
    if (last) break;
    last = done.load();
  }
  producer.join();
  onlooker.join();
  EXPECT_EQ(wrong, 0U);
  EXPECT_EQ(received, taken);
  EXPECT_GT(ring.refused(), 0U);
}

TEST(RingStress, FourPairsOfThreadsWithOnlookers) {
  std::deque<Ring<Item>> rings;
  std::vector<std::thread> pairs;
  for (std::size_t capacity : {1U, 2U, 16U, 1024U})
    pairs.emplace_back([&ring = rings.emplace_back(capacity)] { exchange_through(ring); });
  for (std::thread& pair : pairs) pair.join();
}

void exchange_through(Snapshot<Item>& snapshot) {
  std::atomic<std::uint64_t> published{0};
  std::atomic<bool> done{false};
  std::thread writer{[&] {
    stress([&] {
      for (int i = 0; i < kBatch; ++i) {
        const std::uint64_t next = published.load(std::memory_order_relaxed) + 1;
        snapshot.publish(Item::numbered(next));
        published.store(next, std::memory_order_relaxed);
      }
    });
    done.store(true);
  }};
  std::uint64_t shown = 0, wrong = 0, updates = 0;
  for (bool last = false;;) {
    if (snapshot.update()) {
      ++updates;
      ++shown;
      const std::uint64_t newest = published.load(std::memory_order_relaxed) + 1;  // the one just being published
      while (shown <= newest && !snapshot.value().is(shown)) ++shown;              // numbers only rise
      wrong += shown <= newest ? 0 : 1;
    } else if (last) {
      break;
    }
    last = done.load();
  }
  writer.join();
  EXPECT_EQ(wrong, 0U);
  EXPECT_TRUE(snapshot.value().is(published.load()));
  EXPECT_GT(updates, 0U);
}

TEST(SnapshotStress, FourPairsOfThreads) {
  std::deque<Snapshot<Item>> snapshots;
  std::vector<std::thread> pairs;
  for (int i = 0; i < 4; ++i)
    pairs.emplace_back([&snapshot = snapshots.emplace_back(Item::numbered(0))] { exchange_through(snapshot); });
  for (std::thread& pair : pairs) pair.join();
}

}  // namespace
}  // namespace stillcut
