// Starts the real-time thread: fixed priority above ordinary work (SCHED_FIFO), optionally a processor of its own,
// memory locked and stack touched beforehand, so that no page fault meets the loop, and processors kept from deep sleep
// while it lives (where the host has /dev/cpu_dma_latency and lets it be written). What this host does not
// permit is left out and reported, never an error: in shadow mode a late tick harms nobody. Whether a
// report is good enough for active mode is the caller's decision. Where memory cannot be locked, the program is brought
// in all the same.
#pragma once

#include <pthread.h>

#include <functional>
#include <string>

namespace stillcut {

// While a thread bears this name it must neither allocate, lock, fault, nor call the system beyond receive, sleep and
// clock: the audit (tests/system/audit) counts on threads of this name only.
inline constexpr const char* kLoopThreadName = "stillcut-loop";

struct RealTimeSettings {
  int priority = 80;        // SCHED_FIFO, 1..99
  int cpu = -1;             // the processor it may run on; -1: any
  bool lock_memory = true;  // of the whole process, present and future
};

// What was achieved of what was asked; a thing not asked for counts as achieved.
struct RealTimeReport {
  bool fifo = false;
  bool affinity = false;
  bool memory_locked = false;
  bool stack_prefaulted = false;
  bool timer_slack = false;  // wake-ups are not put off to be bundled (matters only without SCHED_FIFO)
  std::string reasons;       // for each thing missing: what, why and what mends it; empty when all is there

  [[nodiscard]] bool complete() const noexcept {
    return fifo && affinity && memory_locked && stack_prefaulted && timer_slack;
  }
};

// An ordinary thread makes, asks and joins it.
class RealTimeThread {
 public:
  // Returns when the new thread is set up and about to run `body`, which must not throw; it runs under the name
  // kLoopThreadName. Throws std::system_error only when no thread at all can be had.
  RealTimeThread(const RealTimeSettings& settings, std::function<void()> body);
  ~RealTimeThread() { join(); }

  RealTimeThread(const RealTimeThread&) = delete;
  RealTimeThread& operator=(const RealTimeThread&) = delete;

  [[nodiscard]] const RealTimeReport& report() const noexcept { return report_; }
  void join() noexcept;  // waits for the end of `body`; a second call does nothing

 private:
  RealTimeReport report_;
  pthread_t thread_{};
  bool joinable_ = false;
  int awake_device_ = -1;
};

}  // namespace stillcut
