// How late and how long: a histogram of durations in nanoseconds with fixed bins, from which percentiles are read.
// Bins are log-linear: exact below 32 ns, then 32 equal bins an octave, so a percentile is at most 1/32 (3.2 %) too
// high and never too low; the maximum is exact. Nothing is allocated and nothing saturates before 2^40 ns (18 min).
//
//   thread      method                             progress
//   one writer  record                             wait-free, a few instructions
//   any         count, percentile_ns, max_ns,      wait-free; while the writer records, a reading may lack the newest
//               summary, for_each                  values, but never shows one that was not recorded
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace stillcut {

struct LatencySummary {
  std::uint64_t count = 0;
  std::int64_t p50_ns = 0, p99_ns = 0, p999_ns = 0, p9999_ns = 0, max_ns = 0;
};

class LatencyHistogram {
 public:
  // A negative duration counts as zero, one beyond the range in the last bin.
  void record(std::int64_t duration_ns) noexcept {
    const auto value = static_cast<std::uint64_t>(std::max<std::int64_t>(duration_ns, 0));
    // One writer: a load and a store do, no read-modify-write is needed. Relaxed: the counts order no other data.
    std::atomic<std::uint64_t>& bin = bins_[bin_of(value)];
    bin.store(bin.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
    if (value > max_.load(std::memory_order_relaxed)) max_.store(value, std::memory_order_relaxed);
  }

  [[nodiscard]] std::uint64_t count() const noexcept {
    std::uint64_t total = 0;
    for (const auto& bin : bins_) total += bin.load(std::memory_order_relaxed);
    return total;
  }

  [[nodiscard]] std::int64_t max_ns() const noexcept {
    return static_cast<std::int64_t>(max_.load(std::memory_order_relaxed));
  }

  // The smallest bin's upper edge that at least `fraction` (0..1) of the durations do not exceed; 0 when there is none.
  [[nodiscard]] std::int64_t percentile_ns(double fraction) const noexcept {
    const std::uint64_t total = count();
    if (total == 0) return 0;
    const double rank = std::ceil(std::clamp(fraction, 0.0, 1.0) * static_cast<double>(total));
    std::uint64_t below = 0;
    for (std::size_t i = 0; i < bins_.size(); ++i) {
      below += bins_[i].load(std::memory_order_relaxed);
      if (below != 0 && static_cast<double>(below) >= rank) return std::min(upper_edge(i), max_ns());
    }
    return max_ns();
  }

  // visit(longest duration in ns, how many) of every bin that is not empty, shortest first.
  template <typename Visit>
  void for_each(Visit&& visit) const {
    for (std::size_t i = 0; i < bins_.size(); ++i)
      if (const std::uint64_t count = bins_[i].load(std::memory_order_relaxed); count != 0)
        visit(std::min(upper_edge(i), max_ns()), count);
  }

  [[nodiscard]] LatencySummary summary() const noexcept {
    return {count(), percentile_ns(0.5), percentile_ns(0.99), percentile_ns(0.999), percentile_ns(0.9999), max_ns()};
  }

 private:
  static constexpr int kBinsPerOctaveLog2 = 5, kRangeLog2 = 40;
  static constexpr std::size_t kBinsPerOctave = std::size_t{1} << kBinsPerOctaveLog2;
  static constexpr std::size_t kBins = (kRangeLog2 - kBinsPerOctaveLog2 + 1) * kBinsPerOctave;
  static_assert(std::atomic<std::uint64_t>::is_always_lock_free);

  static std::size_t bin_of(std::uint64_t value) noexcept {
    if (value < kBinsPerOctave) return static_cast<std::size_t>(value);
    const int octave = std::bit_width(value) - 1 - kBinsPerOctaveLog2;  // 0 for the first octave above the exact bins
    const auto within = static_cast<std::size_t>(value >> octave) - kBinsPerOctave;
    return std::min((static_cast<std::size_t>(octave) + 1) * kBinsPerOctave + within, kBins - 1);
  }
  static std::int64_t upper_edge(std::size_t bin) noexcept {
    if (bin < kBinsPerOctave) return static_cast<std::int64_t>(bin);
    if (bin == kBins - 1) return INT64_MAX;  // holds everything beyond the range, too: the maximum limits it
    const std::size_t octave = bin / kBinsPerOctave - 1, within = bin % kBinsPerOctave;
    return (static_cast<std::int64_t>(kBinsPerOctave + within + 1) << octave) - 1;
  }

  std::array<std::atomic<std::uint64_t>, kBins> bins_{};
  std::atomic<std::uint64_t> max_{0};
};

}  // namespace stillcut
