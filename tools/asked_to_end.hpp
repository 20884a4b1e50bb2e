// ^C and SIGTERM, kept from killing the process: asked for instead. Make it before any thread.
#pragma once

#include <pthread.h>
#include <signal.h>

#include <ctime>

namespace stillcut {

class AskedToEnd {
 public:
  AskedToEnd() {
    sigemptyset(&signals_);
    sigaddset(&signals_, SIGINT);
    sigaddset(&signals_, SIGTERM);
    pthread_sigmask(SIG_BLOCK, &signals_, nullptr);
  }
  bool operator()() {
    constexpr timespec kNow{};
    return asked_ = asked_ || sigtimedwait(&signals_, nullptr, &kNow) > 0;
  }

 private:
  sigset_t signals_{};
  bool asked_ = false;
};

}  // namespace stillcut
