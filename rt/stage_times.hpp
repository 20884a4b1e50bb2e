// Where the loop's time goes: for every tick the time spent in each stage, in a histogram each. The loop itself keeps
// them: a read of the clock where one stage ends and the next begins (two dozen nanoseconds; a few an incoming frame).
// Where reading the clock is dear, as on an emulated machine, only every 16th tick is timed.
//
//   thread   method                             progress
//   loop     begin_tick, begin, end_tick        wait-free; no allocation, no lock, no system call but the clock
//   any      histogram, summary                 wait-free
#pragma once

#include <array>
#include <cstdint>

#include "dsp/stage_probe.hpp"
#include "rt/latency_histogram.hpp"
#include "rt/periodic.hpp"

namespace stillcut {

class StageTimes {
 public:
  // Reads the clock a hundred times to see what that costs; an ordinary thread.
  StageTimes() noexcept {
    constexpr int kReads = 100;
    constexpr std::int64_t kDear_ns = 1000;
    const std::int64_t start_ns = monotonic_ns();
    std::int64_t end_ns = start_ns;
    for (int i = 0; i < kReads; ++i) end_ns = monotonic_ns();
    if (end_ns - start_ns > kReads * kDear_ns) every_ = 16;
  }

  [[nodiscard]] StageProbe probe() noexcept {
    return {[](void* self, Stage stage) noexcept { static_cast<StageTimes*>(self)->begin(stage); }, this};
  }

  void begin_tick() noexcept {
    timed_ = tick_++ % every_ == 0;
    spent_ns_.fill(0);
    stage_ = Stage::receive;
    if (timed_) since_ns_ = monotonic_ns();
  }
  void begin(Stage stage) noexcept {
    if (!timed_ || stage == stage_) return;
    const std::int64_t now_ns = monotonic_ns();
    spent_ns_[index(stage_)] += now_ns - since_ns_;
    since_ns_ = now_ns;
    stage_ = stage;
  }
  // A stage that did not come up in this tick is not counted as one of no time.
  void end_tick() noexcept {
    if (!timed_) return;
    spent_ns_[index(stage_)] += monotonic_ns() - since_ns_;
    for (int s = 0; s < kStages; ++s) {
      if (spent_ns_[s] > 0) histograms_[s].record(spent_ns_[s]);
    }
    timed_ = false;
  }

  [[nodiscard]] const LatencyHistogram& histogram(Stage stage) const noexcept { return histograms_[index(stage)]; }
  [[nodiscard]] int timed_every() const noexcept { return every_; }

 private:
  static constexpr std::size_t index(Stage stage) noexcept { return static_cast<std::size_t>(stage); }

  std::array<LatencyHistogram, kStages> histograms_;
  std::array<std::int64_t, kStages> spent_ns_{};
  std::int64_t since_ns_ = 0;
  std::uint32_t tick_ = 0;
  int every_ = 1;
  Stage stage_ = Stage::receive;
  bool timed_ = false;
};

}  // namespace stillcut
