// The system-call audit of the real-time loop: from install() to release() the calling thread may receive, sleep and
// read the clock; any other system call ends the program with one line that names it (status 134, core dump at the
// very call). For tests and acceptance runs, not for production: the design promises such a loop, this proves it.
//
// How: a seccomp filter on that thread alone lets the permitted calls pass and hands all others to a watcher thread,
// which aborts the program while the loop runs and lets them pass after release(): a filter cannot be
// removed, and a thread needs a few calls to end. Permitted calls pay some tens of nanoseconds, the watcher costs
// nothing.
#pragma once

#include <atomic>
#include <string>
#include <thread>

namespace stillcut {

class LoopSyscallFilter {
 public:
  LoopSyscallFilter();   // ordinary thread, before the loop's thread starts; starts the watcher
  ~LoopSyscallFilter();  // ordinary thread, after the loop's thread was joined

  LoopSyscallFilter(const LoopSyscallFilter&) = delete;
  LoopSyscallFilter& operator=(const LoopSyscallFilter&) = delete;

  // Loop's thread, once, after its set-up. Allocates nothing. 0, or errno: the kernel (5.5 or newer is needed) or a
  // sandbox refuses; then nothing is watched.
  [[nodiscard]] int install() noexcept;

  // Loop's thread, after its last tick.
  void release() noexcept { released_.store(true, std::memory_order_release); }

 private:
  void watch() noexcept;

  std::atomic<int> listener_{-1};
  std::atomic<bool> released_{false}, closing_{false};
  std::thread watcher_;
};

}  // namespace stillcut
