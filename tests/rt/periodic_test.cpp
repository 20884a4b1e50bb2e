#include "rt/periodic.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <thread>
#include <vector>

namespace stillcut {
namespace {

constexpr std::int64_t kPeriod = 1'000'000;

TEST(Periodic, RunsUntilTheTickSaysNo) {
  LoopStatistics statistics;
  const std::atomic<bool> stop{false};
  int ticks = 0;
  run_periodic(kPeriod, stop, statistics, [&](std::int64_t) noexcept { return ++ticks < 25; });
  EXPECT_EQ(ticks, 25);
  EXPECT_EQ(statistics.ticks.load(), 25U);
  EXPECT_EQ(statistics.wakeup.count(), 25U);
  EXPECT_EQ(statistics.execution.count(), 25U);
}

TEST(Periodic, NeverRunsWhenStoppedBeforehand) {
  LoopStatistics statistics;
  const std::atomic<bool> stop{true};
  run_periodic(kPeriod, stop, statistics, [](std::int64_t) noexcept { return true; });
  EXPECT_EQ(statistics.ticks.load(), 0U);
}

TEST(Periodic, StopsWhenAnotherThreadAsks) {
  LoopStatistics statistics;
  std::atomic<bool> stop{false};
  std::thread loop{[&] { run_periodic(kPeriod, stop, statistics, [](std::int64_t) noexcept { return true; }); }};
  while (statistics.ticks.load(std::memory_order_relaxed) < 5) std::this_thread::yield();
  stop.store(true, std::memory_order_release);
  loop.join();
  EXPECT_GE(statistics.ticks.load(), 5U);
}

TEST(Periodic, NeverWakesEarlyOnItsGrid) {
  LoopStatistics statistics;
  const std::atomic<bool> stop{false};
  std::vector<std::int64_t> wakes;
  wakes.reserve(50);
  const std::int64_t begin = monotonic_ns();
  run_periodic(kPeriod, stop, statistics, [&](std::int64_t now_ns) noexcept {
    wakes.push_back(now_ns);
    return wakes.size() < 50;
  });
  // However late the machine, tick k comes after k + 1 periods, and skipped ones move it further out.
  for (std::size_t k = 0; k < wakes.size(); ++k) {
    EXPECT_GE(wakes[k], begin + static_cast<std::int64_t>(k + 1) * kPeriod);
  }
  EXPECT_GE(wakes.back(), begin + static_cast<std::int64_t>(50 + statistics.skipped.load()) * kPeriod);
}

TEST(Periodic, LeavesOutTheTicksThatAnOverrunMissed) {
  LoopStatistics statistics;
  const std::atomic<bool> stop{false};
  std::vector<std::int64_t> wakes;
  wakes.reserve(10);
  std::int64_t end_of_long_tick = 0;
  run_periodic(kPeriod, stop, statistics, [&](std::int64_t now_ns) noexcept {
    wakes.push_back(now_ns);
    if (wakes.size() == 5) {
      while (monotonic_ns() < now_ns + 7 * kPeriod / 2) {  // three wake-ups fall into it
      }
      end_of_long_tick = monotonic_ns();
    }
    return wakes.size() < 10;
  });
  EXPECT_GE(statistics.overruns.load(), 1U);
  EXPECT_GE(statistics.skipped.load(), 3U);
  EXPECT_LE(statistics.overruns.load(), statistics.skipped.load());
  EXPECT_GT(wakes[5], end_of_long_tick) << "the next tick waits for a fresh wake-up time";
  EXPECT_GE(statistics.execution.max_ns(), 7 * kPeriod / 2);
  EXPECT_EQ(statistics.ticks.load(), 10U);
}

TEST(Periodic, ASignalCausesNoTickOfItsOwn) {
  std::signal(SIGUSR1, [](int) {});
  LoopStatistics statistics;
  const std::atomic<bool> stop{false};
  std::atomic<bool> ended{false};
  const std::int64_t begin = monotonic_ns();
  std::int64_t end = 0;
  std::thread loop{[&] {
    std::uint64_t ticks = 0;
    run_periodic(10 * kPeriod, stop, statistics, [&](std::int64_t now_ns) noexcept {
      end = now_ns;
      return ++ticks < 5;
    });
    ended.store(true, std::memory_order_release);
  }};
  while (!ended.load(std::memory_order_acquire)) {
    pthread_kill(loop.native_handle(), SIGUSR1);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  loop.join();
  EXPECT_GE(end, begin + 50 * kPeriod);
}

}  // namespace
}  // namespace stillcut
