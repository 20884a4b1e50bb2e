// Counts what the real-time loop must never do: heap calls, locks and all else by which threads wait for one another,
// and page faults, by any thread while it bears the name kLoopThreadName. To be preloaded into an unchanged program:
//
//   LD_PRELOAD=build/.../libloop_audit.so stillcutd CELL
//   LOOP_AUDIT=abort LD_PRELOAD=...                          stops at the first such call, for a debugger
//
// Prints one line at exit and turns the exit status into 1 if anything was counted, or if no thread ever bore the name
// (an audit of nothing must not pass). operator new and the C library's own buffers arrive here through malloc. A lock
// counts whether or not anybody else holds it: that it is free today is luck. The C library's own locks (of its
// streams, say) do not pass through here; they show as system calls when contended. How often the loop slept and was
// switched is printed beside, as information. glibc only; not for programs built with a sanitizer, which replaces
// malloc itself.
#include <dlfcn.h>
#include <pthread.h>
#include <semaphore.h>
#include <sys/resource.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>

#include "rt/thread.hpp"

extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);
void __libc_free(void*);
}

namespace {

std::atomic<long> allocations{0}, releases{0}, locks{0}, threads{0};
std::atomic<long> faults{0}, major_faults{0}, sleeps{0}, waits{0}, preemptions{0};

// initial-exec: reading it must not itself allocate.
thread_local bool audited __attribute__((tls_model("initial-exec"))) = false;
thread_local rusage usage_before __attribute__((tls_model("initial-exec")));

void note(std::atomic<long>& count) {
  if (!audited) return;
  count.fetch_add(1, std::memory_order_relaxed);
  const char* mode = std::getenv("LOOP_AUDIT");
  if (mode != nullptr && std::strcmp(mode, "abort") == 0) std::abort();
}

// The C library's own function of that name. The lookup happens at the first call, which start-up code makes.
template <typename Function>
Function next(std::atomic<Function>& cached, const char* name) {
  Function function = cached.load(std::memory_order_relaxed);
  if (function == nullptr) {
    function = reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
    cached.store(function, std::memory_order_relaxed);
  }
  return function;
}

void begin_audit() {
  threads.fetch_add(1, std::memory_order_relaxed);
  getrusage(RUSAGE_THREAD, &usage_before);
  audited = true;
}

void end_audit() {
  audited = false;
  rusage usage{};
  getrusage(RUSAGE_THREAD, &usage);
  const long major = usage.ru_majflt - usage_before.ru_majflt;
  faults += usage.ru_minflt - usage_before.ru_minflt + major;
  major_faults += major;
  waits += usage.ru_nvcsw - usage_before.ru_nvcsw;
  preemptions += usage.ru_nivcsw - usage_before.ru_nivcsw;
}

[[gnu::destructor]] void report() {
  std::fprintf(stderr,
               "loop_audit: %ld allocations, %ld releases, %ld locks, %ld page faults (%ld major) in %ld sleeps; "
               "switched %ld times by itself, %ld times by the kernel; in %ld thread(s) named %s\n",
               allocations.load(), releases.load(), locks.load(), faults.load(), major_faults.load(), sleeps.load(),
               waits.load(), preemptions.load(), threads.load(), stillcut::kLoopThreadName);
  if (allocations + releases + locks + faults != 0 || threads == 0) {
    std::fflush(nullptr);
    _exit(1);
  }
}

}  // namespace

extern "C" {

void* malloc(std::size_t size) {
  note(allocations);
  return __libc_malloc(size);
}

void* calloc(std::size_t count, std::size_t size) {
  note(allocations);
  return __libc_calloc(count, size);
}

void* realloc(void* old, std::size_t size) {
  note(allocations);
  return __libc_realloc(old, size);
}

void* memalign(std::size_t alignment, std::size_t size) {
  note(allocations);
  return __libc_memalign(alignment, size);
}

void* aligned_alloc(std::size_t alignment, std::size_t size) {
  note(allocations);
  return __libc_memalign(alignment, size);
}

int posix_memalign(void** out, std::size_t alignment, std::size_t size) {
  note(allocations);
  void* block = __libc_memalign(alignment, size);
  if (block == nullptr) return ENOMEM;
  *out = block;
  return 0;
}

void free(void* block) {
  if (block != nullptr) note(releases);
  __libc_free(block);
}

// HOOK(COUNT, NAME, (PARAMETERS), (ARGUMENTS)): counts the call and hands it on.
#define HOOK(count, name, parameters, arguments)  \
  int name parameters {                           \
    static std::atomic<int(*) parameters> cached; \
    note(count);                                  \
    return next(cached, #name) arguments;         \
  }

HOOK(locks, pthread_mutex_lock, (pthread_mutex_t * m), (m))
HOOK(locks, pthread_mutex_trylock, (pthread_mutex_t * m), (m))
HOOK(locks, pthread_mutex_timedlock, (pthread_mutex_t * m, const timespec* t), (m, t))
HOOK(locks, pthread_mutex_clocklock, (pthread_mutex_t * m, clockid_t c, const timespec* t), (m, c, t))
HOOK(locks, pthread_rwlock_rdlock, (pthread_rwlock_t * l), (l))
HOOK(locks, pthread_rwlock_wrlock, (pthread_rwlock_t * l), (l))
HOOK(locks, pthread_rwlock_tryrdlock, (pthread_rwlock_t * l), (l))
HOOK(locks, pthread_rwlock_trywrlock, (pthread_rwlock_t * l), (l))
HOOK(locks, pthread_spin_lock, (pthread_spinlock_t * l), (l))
HOOK(locks, pthread_spin_trylock, (pthread_spinlock_t * l), (l))
HOOK(locks, pthread_barrier_wait, (pthread_barrier_t * b), (b))
HOOK(locks, pthread_cond_wait, (pthread_cond_t * c, pthread_mutex_t* m), (c, m))
HOOK(locks, pthread_cond_timedwait, (pthread_cond_t * c, pthread_mutex_t* m, const timespec* t), (c, m, t))
HOOK(locks, pthread_cond_clockwait, (pthread_cond_t * c, pthread_mutex_t* m, clockid_t k, const timespec* t),
     (c, m, k, t))
HOOK(locks, pthread_cond_signal, (pthread_cond_t * c), (c))
HOOK(locks, pthread_cond_broadcast, (pthread_cond_t * c), (c))
HOOK(locks, sem_wait, (sem_t * s), (s))
HOOK(locks, sem_trywait, (sem_t * s), (s))
HOOK(locks, sem_timedwait, (sem_t * s, const timespec* t), (s, t))
HOOK(locks, sem_post, (sem_t * s), (s))
HOOK(locks, __cxa_guard_acquire, (std::int64_t * guard), (guard))  // a variable `static` in a function, at first use

int clock_nanosleep(clockid_t clock, int flags, const timespec* until, timespec* left) {
  static std::atomic<int (*)(clockid_t, int, const timespec*, timespec*)> cached;
  if (audited) sleeps.fetch_add(1, std::memory_order_relaxed);
  return next(cached, "clock_nanosleep")(clock, flags, until, left);
}

// A thread is audited from the moment it takes the name until it takes another.
int pthread_setname_np(pthread_t thread, const char* name) {
  static std::atomic<int (*)(pthread_t, const char*)> cached;
  const bool own = pthread_equal(thread, pthread_self()) != 0;
  if (own && audited) end_audit();
  const int result = next(cached, "pthread_setname_np")(thread, name);
  if (own && std::strcmp(name, stillcut::kLoopThreadName) == 0) begin_audit();
  return result;
}

}  // extern "C"
