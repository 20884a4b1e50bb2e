// A real-time loop on the project's own primitives, to prove the audits on: it pushes into a ring, reads a snapshot and
// steps a trajectory at 10 kHz, and can be told to misbehave once, in the middle of the run.
//
//   audit_demo [--ticks N] [--filter]
//              [--plant malloc|free|lock|try_lock|read_lock|notify|semaphore|static|touch|syscall|sleep]
#include <pthread.h>
#include <semaphore.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <shared_mutex>
#include <string>
#include <thread>

#include "rt/periodic.hpp"
#include "rt/ring.hpp"
#include "rt/snapshot.hpp"
#include "rt/syscall_filter.hpp"
#include "rt/thread.hpp"
#include "rt/trajectory.hpp"

namespace {

using namespace stillcut;

constexpr std::int64_t kPeriodNs = 100'000;

std::mutex mutex;
std::shared_mutex shared_mutex;
std::condition_variable condition;
sem_t semaphore;
void* volatile block = nullptr;  // volatile: a pair of malloc and free that nobody looks at would be compiled away

std::atomic<volatile char*> fresh{nullptr};  // a page that is not there yet

// Memory is locked for good, so a page has to be taken away to be missing.
void take_a_page_away() {
  void* page = mmap(nullptr, 4096, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  munlock(page, 4096);
  madvise(page, 4096, MADV_DONTNEED);
  fresh.store(static_cast<char*>(page), std::memory_order_release);
}

std::int64_t first_use() {
  static const std::int64_t once = monotonic_ns();
  return once;
}

void misbehave(const std::string& how) {
  if (how == "malloc") block = std::malloc(64);
  if (how == "free") std::free(block);
  if (how == "lock") std::lock_guard guard{mutex};
  if (how == "try_lock" && mutex.try_lock()) mutex.unlock();
  if (how == "read_lock") std::shared_lock guard{shared_mutex};
  if (how == "notify") condition.notify_one();
  if (how == "semaphore") sem_post(&semaphore);
  if (how == "static") (void)first_use();
  if (how == "touch") *fresh.load(std::memory_order_acquire) = 1;
  if (how == "syscall") syscall(SYS_getppid);
  if (how == "sleep") std::this_thread::sleep_for(std::chrono::nanoseconds(1));
}

}  // namespace

int main(int count, char** arguments) {
  std::uint64_t ticks = 10'000;
  bool filtered = false;
  std::string plant;
  for (int i = 1; i < count; ++i) {
    const std::string option = arguments[i];
    if (option == "--filter") filtered = true;
    if (option == "--ticks" && i + 1 < count) ticks = std::strtoull(arguments[++i], nullptr, 10);
    if (option == "--plant" && i + 1 < count) plant = arguments[++i];
  }
  sem_init(&semaphore, 0, 0);
  if (plant == "free") block = std::malloc(64);

  Ring<MotionState> out{1024};
  Snapshot<double> target{1000.0};
  LoopStatistics statistics;
  std::atomic<bool> stop{false}, ended{false};
  VelocityTrajectory ramp;
  double ramp_start = 0.0;
  int refused_filter = 0;
  LoopSyscallFilter filter;

  const auto tick = [&](std::int64_t now_ns) noexcept {
    const double now = 1e-9 * static_cast<double>(now_ns);
    const MotionState state = ramp.at(now - ramp_start);
    if (target.update()) {
      ramp = plan_velocity(state, target.value(), 0.0, {2000.0, 20000.0}).trajectory;
      ramp_start = now;
    }
    (void)out.push(state);
    const std::uint64_t done = statistics.ticks.load(std::memory_order_relaxed) + 1;
    if (done == ticks / 2 && !plant.empty()) misbehave(plant);
    return done < ticks;
  };
  RealTimeThread thread{{}, [&] {
                          if (filtered) refused_filter = filter.install();
                          run_periodic(kPeriodNs, stop, statistics, tick);
                          filter.release();
                          ended.store(true, std::memory_order_release);
                        }};

  if (plant == "touch") take_a_page_away();
  MotionState state;
  for (double speed = 1000.0; !ended.load(std::memory_order_acquire); speed = 4000.0 - speed) {
    target.publish(speed);
    while (out.pop(state)) {
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  thread.join();

  const LatencySummary late = statistics.wakeup.summary();
  std::printf("%llu ticks, %llu overruns; woken late p50 %.1f us, p99 %.1f us, max %.1f us%s%s\n",
              static_cast<unsigned long long>(statistics.ticks.load()),
              static_cast<unsigned long long>(statistics.overruns.load()), 1e-3 * static_cast<double>(late.p50_ns),
              1e-3 * static_cast<double>(late.p99_ns), 1e-3 * static_cast<double>(late.max_ns),
              thread.report().complete() ? "" : "; ", thread.report().reasons.c_str());
  if (refused_filter != 0) {
    std::printf("no system-call filter: %s\n", std::strerror(refused_filter));
    return 77;  // CTest: skipped
  }
  return 0;
}
