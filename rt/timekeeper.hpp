// Does the loop keep time? Single late ticks are skipped and counted (rt/periodic.hpp). Where they add up, or the
// machine stands still for longer than a correction may go unattended, the loop is out of time: then it degrades to
// listening, and what it has asked for is released until it has kept time again for a while. A function of the times
// of waking; the loop's thread, no clock, nothing allocated.
#pragma once

#include <algorithm>
#include <cstdint>

namespace stillcut {

struct TimekeepingLimits {
  std::int64_t longest_gap_ns = 25'000'000;       // between ticks: a robot controller misses two of its cycles of 12 ms
  double missed_share = 0.1;                      // of the ticks of the last second
  std::int64_t in_time_again_ns = 1'000'000'000;  // without a gap of more than five periods
};

class Timekeeper {
 public:
  explicit Timekeeper(std::int64_t period_ns, const TimekeepingLimits& limits = {}) noexcept
      : period_ns_{period_ns}, limits_{limits} {}

  // A tick has woken. True when in_time() has changed.
  bool tick(std::int64_t awake_ns) noexcept {
    const bool was_in_time = in_time_;
    if (last_ns_ != 0) {
      const std::int64_t gap_ns = awake_ns - last_ns_;
      const double seconds = static_cast<double>(gap_ns) * 1e-9;
      const double missed = static_cast<double>(std::max<std::int64_t>(0, gap_ns / period_ns_ - 1));
      const double allowed = limits_.missed_share * 1e9 / static_cast<double>(period_ns_);
      // Missed ticks of about the last second: a running sum that forgets, and of which one long gap is no more than
      // twice what is allowed.
      missed_ = std::min(2.0 * allowed, missed_ * (1.0 - std::min(1.0, seconds)) + missed);
      if (gap_ns > 5 * period_ns_) quiet_since_ns_ = awake_ns;
      if (gap_ns > limits_.longest_gap_ns || missed_ > allowed) {
        in_time_ = false;
        quiet_since_ns_ = awake_ns;
        longest_gap_ns_ = std::max(longest_gap_ns_, gap_ns);
      } else if (!in_time_ && awake_ns - quiet_since_ns_ >= limits_.in_time_again_ns) {
        in_time_ = true;
        longest_gap_ns_ = 0;
      }
    }
    last_ns_ = awake_ns;
    return in_time_ != was_in_time;
  }

  [[nodiscard]] bool in_time() const noexcept { return in_time_; }
  // Since it fell out of time; 0 while in time.
  [[nodiscard]] std::int64_t longest_gap_ns() const noexcept { return longest_gap_ns_; }

 private:
  std::int64_t period_ns_;
  TimekeepingLimits limits_;
  std::int64_t last_ns_ = 0, quiet_since_ns_ = 0, longest_gap_ns_ = 0;
  double missed_ = 0.0;
  bool in_time_ = true;
};

}  // namespace stillcut
