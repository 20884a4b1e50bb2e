// Can the samples be believed? Finds what makes a sensor worthless while it still sends: values that are no numbers, a
// channel that stands still, one that sits at the end of its range.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "dsp/lanes.hpp"
#include "dsp/signals.hpp"

namespace stillcut {

// Reasons not to trust what is heard; bits, so that several can hold at once.
enum Doubt : std::uint32_t {
  kNoDoubt = 0,
  kGap = 1U << 0,               // samples are missing
  kSaturated = 1U << 1,         // three samples in a row at the end of the range
  kStuck = 1U << 2,             // sixteen equal samples while the signal is not zero
  kNotFinite = 1U << 3,         // NaN or infinity
  kSpeedMissing = 1U << 4,      // no speed message for too long
  kSpeedImplausible = 1U << 5,  // negative, not a number, far beyond the spindle, or zero while the tool cuts
  kSensorSilent = 1U << 6,      // no samples at all
};
inline constexpr int kDoubtCount = 7;

// One line for people, e.g. "accelerometer saturated".
const char* describe(Doubt single) noexcept;

class SampleCheck {
 public:
  // Looks at sample `i` of a block; returns the doubts that it raises (kSaturated, kStuck, kNotFinite). Real-time
  // thread.
  std::uint32_t check(const SampleBlock& block, int i) noexcept;
  // Looks at several samples of a block at once, each present axis on a lane: true when none of them raises a doubt.
  // False when one may; then nothing is remembered of them, and check() must look at each.
  bool beyond_doubt(const SampleBlock& block, std::span<const Lanes> x) noexcept;
  void forget_runs() noexcept;

 private:
  static constexpr int kEqualToBeStuck = 16, kZerosToBeDead = 256, kFullScaleToBeSaturated = 3;

  std::array<float, kMaxAxes> last_{};
  std::array<int, kMaxAxes> equal_{}, full_{};
};

}  // namespace stillcut
