#include "tools/real_time_check.hpp"

#include <cstdio>
#include <string>

#include "drivers/files/input_error.hpp"
#include "rt/periodic.hpp"

namespace stillcut {
namespace {

constexpr int kRehearsedTicks = 200;
constexpr std::int64_t kLate_ns = kLoopPeriodNs / 2, kLatest_ns = 5 * kLoopPeriodNs;

}  // namespace

void require_real_time(const RealTimeSettings& settings) {
  const std::atomic<bool> go_on{false};
  LoopStatistics seen;
  RealTimeThread rehearsal{settings, [&] {
                             int left = kRehearsedTicks;
                             run_periodic(kLoopPeriodNs, go_on, seen,
                                          [&](std::int64_t) noexcept { return --left > 0; });
                           }};
  rehearsal.join();
  std::string reasons = rehearsal.report().reasons;
  const LatencySummary wakeup = seen.wakeup.summary();
  if (wakeup.p99_ns > kLate_ns || wakeup.max_ns > kLatest_ns) {
    char late[128];
    std::snprintf(late, sizeof late, "%sin %d ticks it woke up to %.2f ms late (p99 %.2f ms)",
                  reasons.empty() ? "" : "; ", kRehearsedTicks, static_cast<double>(wakeup.max_ns) * 1e-6,
                  static_cast<double>(wakeup.p99_ns) * 1e-6);
    reasons += late;
  }
  if (reasons.empty()) return;
  throw ComponentError("this host cannot keep time for active mode: " + reasons +
                       "; 'stillcut doctor' tells what to set, mode = \"shadow\" runs as it is, and on the bench "
                       "--allow-not-real-time runs all the same");
}

}  // namespace stillcut
