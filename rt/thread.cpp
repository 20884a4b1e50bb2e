#include "rt/thread.hpp"

#include <fcntl.h>
#include <linux/capability.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <fstream>
#include <future>
#include <memory>
#include <system_error>
#include <utility>

namespace stillcut {
namespace {

constexpr std::size_t kStackBytes = 2 * 1024 * 1024;  // thread-local storage comes off it, too
constexpr std::size_t kPrefaultedBytes = 512 * 1024;
constexpr std::size_t kPageBytes = 4096;

void add_reason(RealTimeReport& report, const std::string& reason) {
  if (!report.reasons.empty()) report.reasons += "; ";
  report.reasons += reason;
}

bool has_capability_ipc_lock() noexcept {
  __user_cap_header_struct header{_LINUX_CAPABILITY_VERSION_3, 0};
  __user_cap_data_struct sets[_LINUX_CAPABILITY_U32S_3]{};
  return syscall(SYS_capget, &header, sets) == 0 &&
         (sets[CAP_TO_INDEX(CAP_IPC_LOCK)].effective & CAP_TO_MASK(CAP_IPC_LOCK));
}

// Future memory is locked only where no limit applies: below a limit the call might pass now, and an ordinary
// allocation fail for it later.
void lock_memory(RealTimeReport& report) {
  rlimit limit{};
  getrlimit(RLIMIT_MEMLOCK, &limit);
  if (limit.rlim_cur != RLIM_INFINITY && !has_capability_ipc_lock()) {
    add_reason(report, "memory not locked: no CAP_IPC_LOCK and a limit of " + std::to_string(limit.rlim_cur / 1024) +
                           " kB; run with LimitMEMLOCK=infinity (ulimit -l unlimited)");
  } else if (mlockall(MCL_CURRENT | MCL_FUTURE) != 0) {
    add_reason(report, std::string("memory not locked: ") + std::strerror(errno));
  } else {
    report.memory_locked = true;
  }
}

// While the device is held open, processors take no rest from which waking takes longer than written there: 0 us. Hosts
// that sleep less deeply anyway, as virtual ones, have no such device.
int keep_processors_awake() noexcept {
  const int device = open("/dev/cpu_dma_latency", O_WRONLY | O_CLOEXEC);
  constexpr std::int32_t kLongest_us = 0;
  if (device >= 0) (void)!write(device, &kLongest_us, sizeof kLongest_us);
  return device;
}

// Where memory cannot be locked, the program is at least all there when the loop starts: code that it calls for the
// first time in its first correction, say. Ordinary memory was touched by those who made it.
void populate_program() {
  std::ifstream maps{"/proc/self/maps"};
  for (std::string line; std::getline(maps, line);) {
    void *begin = nullptr, *end = nullptr;
    char access[5] = {};
    if (std::sscanf(line.c_str(), "%p-%p %4s", &begin, &end, access) != 3) continue;
    if (line.find('/') == std::string::npos || access[0] != 'r' || access[3] != 'p') continue;  // no file of its own
    const auto length = static_cast<std::size_t>(static_cast<std::byte*>(end) - static_cast<std::byte*>(begin));
    madvise(begin, length, access[1] == 'w' ? MADV_POPULATE_WRITE : MADV_POPULATE_READ);
  }
}

// Touches the pages below the caller's frame, which the loop will use later.
[[gnu::noinline]] void prefault_stack() noexcept {
  std::byte stack[kPrefaultedBytes];
  volatile std::byte* const touched = stack;  // volatile: the writes have no other purpose
  for (std::size_t i = 0; i < kPrefaultedBytes; i += kPageBytes) touched[i] = std::byte{1};
}

// The kernel shows the time in a page that is none of the memory that can be locked: the first look at it is a page
// fault.
void touch_clocks() noexcept {
  timespec now{};
  for (const clockid_t clock : {CLOCK_MONOTONIC, CLOCK_REALTIME}) clock_gettime(clock, &now);
}

// Attributes are explicit: a thread otherwise inherits policy and processors from the one that happens to start it.
class Attributes {
 public:
  Attributes() {
    pthread_attr_init(&attributes_);
    pthread_attr_setstacksize(&attributes_, kStackBytes);
    pthread_attr_setinheritsched(&attributes_, PTHREAD_EXPLICIT_SCHED);
  }
  ~Attributes() { pthread_attr_destroy(&attributes_); }
  Attributes(const Attributes&) = delete;
  Attributes& operator=(const Attributes&) = delete;

  int set_fifo(int priority) noexcept {
    const sched_param parameter{priority};
    if (const int error = pthread_attr_setschedpolicy(&attributes_, SCHED_FIFO)) return error;
    return pthread_attr_setschedparam(&attributes_, &parameter);
  }
  void set_ordinary() noexcept {
    const sched_param parameter{0};
    pthread_attr_setschedpolicy(&attributes_, SCHED_OTHER);
    pthread_attr_setschedparam(&attributes_, &parameter);
  }
  int set_processors(const cpu_set_t& processors) noexcept {
    return pthread_attr_setaffinity_np(&attributes_, sizeof processors, &processors);
  }
  [[nodiscard]] const pthread_attr_t* get() const noexcept { return &attributes_; }

 private:
  pthread_attr_t attributes_{};
};

bool set_affinity(Attributes& attributes, int cpu) noexcept {
  if (cpu < 0) return true;
  cpu_set_t allowed;
  if (sched_getaffinity(0, sizeof allowed, &allowed) != 0) return false;
  if (cpu >= CPU_SETSIZE || !CPU_ISSET(cpu, &allowed)) return false;
  cpu_set_t one;
  CPU_ZERO(&one);
  CPU_SET(cpu, &one);
  return attributes.set_processors(one) == 0;
}

struct Start {
  std::function<void()> body;
  std::promise<bool> ready;  // the timer slack could be set
};

void* run(void* argument) {
  const std::unique_ptr<Start> start{static_cast<Start*>(argument)};
  prefault_stack();
  touch_clocks();
  start->ready.set_value(prctl(PR_SET_TIMERSLACK, 1UL, 0, 0, 0) == 0);
  pthread_setname_np(pthread_self(), kLoopThreadName);
  start->body();
  pthread_setname_np(pthread_self(), "stillcut-ended");  // what is freed from here on is not the loop's
  return nullptr;
}

}  // namespace

RealTimeThread::RealTimeThread(const RealTimeSettings& settings, std::function<void()> body) {
  awake_device_ = keep_processors_awake();
  if (settings.lock_memory) {
    lock_memory(report_);
    if (!report_.memory_locked) populate_program();
  } else {
    report_.memory_locked = true;
  }
  Attributes attributes;
  report_.affinity = set_affinity(attributes, settings.cpu);
  if (!report_.affinity) {
    add_reason(report_, "not bound to processor " + std::to_string(settings.cpu) + ": this process may not use it");
  }
  auto start = std::make_unique<Start>(Start{std::move(body), {}});
  std::future<bool> ready = start->ready.get_future();

  int error = attributes.set_fifo(settings.priority);
  if (error == 0) error = pthread_create(&thread_, attributes.get(), run, start.get());
  report_.fifo = error == 0;
  if (!report_.fifo) {
    add_reason(report_, "no SCHED_FIFO priority " + std::to_string(settings.priority) + ": " + std::strerror(error) +
                            "; run with CAP_SYS_NICE or LimitRTPRIO=" + std::to_string(settings.priority));
    attributes.set_ordinary();
    error = pthread_create(&thread_, attributes.get(), run, start.get());
    if (error != 0) throw std::system_error(error, std::generic_category(), "cannot start the real-time thread");
  }
  (void)start.release();  // the thread's now
  joinable_ = true;
  report_.timer_slack = ready.get();
  if (!report_.timer_slack) add_reason(report_, "timer slack not set");
  report_.stack_prefaulted = true;  // needs no permission
}

void RealTimeThread::join() noexcept {
  if (joinable_) pthread_join(thread_, nullptr);
  joinable_ = false;
  if (awake_device_ >= 0) close(awake_device_);
  awake_device_ = -1;
}

}  // namespace stillcut
