// Counts what the real-time loop must never do: heap calls and mutex or read-write locks, made by any thread while it
// bears the name kLoopThreadName. To be preloaded into an unchanged program:
//
//   LD_PRELOAD=build/.../libmalloc_audit.so stillcutd CELL
//   MALLOC_AUDIT=abort LD_PRELOAD=...                        stops at the first such call, for a debugger
//
// Prints one line at exit and turns the exit status into 1 if anything was counted, or if no thread ever bore the name
// (an audit of nothing must not pass). operator new and the C library's own buffers arrive here through malloc.
// Condition variables and semaphores are left to the system-call audit: they reach another thread by a system call or
// not at all. glibc only; not for programs built with a sanitizer, which replaces malloc itself.
#include <dlfcn.h>
#include <pthread.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <cstring>

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

// initial-exec: reading it must not itself allocate.
thread_local bool audited __attribute__((tls_model("initial-exec"))) = false;

void note(std::atomic<long>& count) {
  if (!audited) return;
  count.fetch_add(1, std::memory_order_relaxed);
  const char* mode = std::getenv("MALLOC_AUDIT");
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

template <typename Lock>
int locked(std::atomic<int (*)(Lock*)>& cached, const char* name, Lock* lock) {
  note(locks);
  return next(cached, name)(lock);
}

std::atomic<int (*)(pthread_mutex_t*)> mutex_lock, mutex_trylock;
std::atomic<int (*)(pthread_rwlock_t*)> read_lock, write_lock;
std::atomic<int (*)(pthread_t, const char*)> set_name;

[[gnu::destructor]] void report() {
  const long violations = allocations + releases + locks;
  std::fprintf(stderr, "malloc_audit: %ld allocations, %ld releases, %ld locks in %ld thread(s) named %s\n",
               allocations.load(), releases.load(), locks.load(), threads.load(), stillcut::kLoopThreadName);
  if (violations != 0 || threads == 0) {
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

int pthread_mutex_lock(pthread_mutex_t* mutex) { return locked(mutex_lock, "pthread_mutex_lock", mutex); }
int pthread_mutex_trylock(pthread_mutex_t* mutex) { return locked(mutex_trylock, "pthread_mutex_trylock", mutex); }
int pthread_rwlock_rdlock(pthread_rwlock_t* lock) { return locked(read_lock, "pthread_rwlock_rdlock", lock); }
int pthread_rwlock_wrlock(pthread_rwlock_t* lock) { return locked(write_lock, "pthread_rwlock_wrlock", lock); }

// A thread is audited from the moment it takes the name until it takes another.
int pthread_setname_np(pthread_t thread, const char* name) {
  const int result = next(set_name, "pthread_setname_np")(thread, name);
  if (pthread_equal(thread, pthread_self())) {
    audited = std::strcmp(name, stillcut::kLoopThreadName) == 0;
    if (audited) threads.fetch_add(1, std::memory_order_relaxed);
  }
  return result;
}

}  // extern "C"
