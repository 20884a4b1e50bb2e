// A progress bar on standard error: only on a terminal, only once a task has taken a second, gone when it is done.
#pragma once

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <string>

namespace stillcut {

class Progress {
 public:
  explicit Progress(std::string task) : task_{std::move(task)}, terminal_{isatty(STDERR_FILENO) == 1} {}
  ~Progress() { finish(); }
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  // Takes the bar away, so that results stand on a clean line.
  void finish() {
    if (shown_) std::fputs("\r\033[K", stderr);
    shown_ = false;
  }

  // `share`: how much is done, 0..1. May be called as often as one likes: it draws ten times a second at most.
  void update(double share) {
    if (!terminal_) return;
    const auto now = Clock::now();
    if (now < next_) return;
    next_ = now + std::chrono::milliseconds(100);
    shown_ = true;
    constexpr int kWidth = 40;
    const int full = static_cast<int>(kWidth * std::clamp(share, 0.0, 1.0));
    const std::string bar =
        std::string(static_cast<std::size_t>(full), '#') + std::string(static_cast<std::size_t>(kWidth - full), '.');
    std::fprintf(stderr, "\r%s [%s] %3.0f %%", task_.c_str(), bar.c_str(), 100.0 * std::clamp(share, 0.0, 1.0));
    std::fflush(stderr);
  }

 private:
  using Clock = std::chrono::steady_clock;
  std::string task_;
  bool terminal_;
  bool shown_ = false;
  Clock::time_point next_ = Clock::now() + std::chrono::seconds(1);
};

}  // namespace stillcut
