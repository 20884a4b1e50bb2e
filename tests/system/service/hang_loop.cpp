// Makes the real-time loop of an unchanged daemon hang: preloaded, it lets no sleep of the thread named kLoopThreadName
// end any more once the file exists that HANG_LOOP names. All other threads go on, as with a real hang.
#include <dlfcn.h>
#include <pthread.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <cstring>
#include <ctime>

#include "rt/thread.hpp"

extern "C" int clock_nanosleep(clockid_t clock, int flags, const timespec* request, timespec* remain) {
  using Sleep = int (*)(clockid_t, int, const timespec*, timespec*);
  static const auto next = reinterpret_cast<Sleep>(dlsym(RTLD_NEXT, "clock_nanosleep"));
  static const char* const file = std::getenv("HANG_LOOP");
  std::array<char, 16> name{};
  pthread_getname_np(pthread_self(), name.data(), name.size());
  const bool loop = std::strcmp(name.data(), stillcut::kLoopThreadName) == 0;
  while (loop && file != nullptr && access(file, F_OK) == 0) {
    for (;;) pause();
  }
  return next(clock, flags, request, remain);
}
