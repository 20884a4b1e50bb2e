// The heart-beat of the real-time thread: sleeps until an absolute time on the monotonic clock, runs one tick, and
// again. A late tick does not shift the ones after it. When a tick ends after the next was due (an overrun), the missed
// ones are left out and the next wake-up is the first one still to come on the same grid: catching up would only
// prolong the overload. The loop makes no system call but sleep and clock; what it saw is in LoopStatistics.
#pragma once

#include <atomic>
#include <cassert>
#include <cstdint>
#include <ctime>
#include <type_traits>

#include "rt/latency_histogram.hpp"

namespace stillcut {

inline constexpr std::int64_t kLoopPeriodNs = 1'000'000;  // 1 kHz

// Written by the loop alone; any thread may read at any time.
struct LoopStatistics {
  std::atomic<std::uint64_t> ticks{0};
  std::atomic<std::uint64_t> overruns{0};  // ticks that ended when the next was already due
  std::atomic<std::uint64_t> skipped{0};   // wake-ups left out because of them
  LatencyHistogram wakeup;                 // from the time due to the time awake
  LatencyHistogram execution;              // from awake to the end of the tick
};

// CLOCK_MONOTONIC, ns. Any thread; real-time safe.
[[nodiscard]] inline std::int64_t monotonic_ns() noexcept {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return std::int64_t{now.tv_sec} * 1'000'000'000 + now.tv_nsec;
}

// Runs `tick(now_ns)`, with the time of waking, every period_ns (> 0) until it returns false or `stop` is set; `stop`
// is looked at once a period. To be called on the real-time thread (rt/thread.hpp).
template <typename Tick>
void run_periodic(std::int64_t period_ns, const std::atomic<bool>& stop, LoopStatistics& statistics,
                  Tick&& tick) noexcept {
  static_assert(std::is_nothrow_invocable_r_v<bool, Tick&, std::int64_t>, "bool tick(std::int64_t) noexcept");
  assert(period_ns > 0);
  const auto add = [](std::atomic<std::uint64_t>& counter,
                      std::int64_t n) noexcept {  // one writer: no locked add needed
    counter.store(counter.load(std::memory_order_relaxed) + static_cast<std::uint64_t>(n), std::memory_order_relaxed);
  };
  std::int64_t due_ns = monotonic_ns() + period_ns;
  while (!stop.load(std::memory_order_acquire)) {
    const timespec due{static_cast<std::time_t>(due_ns / 1'000'000'000), static_cast<long>(due_ns % 1'000'000'000)};
    clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &due, nullptr);
    const std::int64_t awake_ns = monotonic_ns();
    if (awake_ns < due_ns) continue;  // a signal ended the sleep
    statistics.wakeup.record(awake_ns - due_ns);
    const bool go_on = tick(awake_ns);
    const std::int64_t end_ns = monotonic_ns();
    statistics.execution.record(end_ns - awake_ns);
    add(statistics.ticks, 1);
    if (!go_on) return;
    due_ns += period_ns;
    if (end_ns >= due_ns) {
      const std::int64_t missed = (end_ns - due_ns) / period_ns + 1;
      add(statistics.overruns, 1);
      add(statistics.skipped, missed);
      due_ns += missed * period_ns;
    }
  }
}

}  // namespace stillcut
