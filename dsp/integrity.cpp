#include "dsp/integrity.hpp"

#include <cmath>

namespace stillcut {

const char* describe(Doubt single) noexcept {
  switch (single) {
    case kGap:
      return "samples missing";
    case kSaturated:
      return "accelerometer saturated";
    case kStuck:
      return "accelerometer stuck at one value";
    case kNotFinite:
      return "accelerometer sends values that are no numbers";
    case kSpeedMissing:
      return "spindle speed missing";
    case kSpeedImplausible:
      return "spindle speed implausible";
    case kSensorSilent:
      return "accelerometer silent";
    case kNoDoubt:
      break;
  }
  return "";
}

std::uint32_t SampleCheck::check(const SampleBlock& block, int i) noexcept {
  std::uint32_t doubts = kNoDoubt;
  for (int a = 0; a < kMaxAxes; ++a) {
    if ((block.axes_present >> a & 1U) == 0) continue;
    const float x = block.acceleration[a][i];
    if (!std::isfinite(x)) {
      doubts |= kNotFinite;
      equal_[a] = full_[a] = 0;
      continue;
    }
    full_[a] = (block.full_scale[a] >> i & 1U) != 0 ? full_[a] + 1 : 0;
    if (full_[a] >= kFullScaleToBeSaturated) doubts |= kSaturated;
    // A sensor may hold each value for two or three samples (a slower source behind it); eight is a stuck one. Zeros
    // are given longer: a coarse sensor at rest reads zero for a while.
    equal_[a] = x == last_[a] ? equal_[a] + 1 : 1;
    last_[a] = x;
    if (equal_[a] >= (x == 0.0F ? kZerosToBeDead : kEqualToBeStuck) && full_[a] == 0) doubts |= kStuck;
  }
  return doubts;
}

void SampleCheck::forget_runs() noexcept {
  equal_.fill(0);
  full_.fill(0);
}

}  // namespace stillcut
