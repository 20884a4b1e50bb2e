#include "dsp/integrity.hpp"

#include <bit>
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

bool SampleCheck::beyond_doubt(const SampleBlock& block, int from, int to) noexcept {
  constexpr std::uint32_t kExponent = 0x7F800000U;  // all ones in what is no number
  std::array<int, kMaxAxes> equal{};
  for (int a = 0; a < kMaxAxes; ++a) {
    if ((block.axes_present >> a & 1U) == 0) continue;
    if (full_[a] != 0 || block.full_scale[a] != 0) return false;
    const float* const x = block.acceleration[a].data();
    int repeated = x[from] == last_[a] ? 1 : 0, not_finite = 0;
    for (int i = from + 1; i < to; ++i) repeated += x[i] == x[i - 1] ? 1 : 0;
    for (int i = from; i < to; ++i) not_finite += (std::bit_cast<std::uint32_t>(x[i]) & kExponent) == kExponent ? 1 : 0;
    // However they lie, this few equal neighbours make no run that is too long.
    if (not_finite > 0 || equal_[a] + repeated >= kEqualToBeStuck) return false;
    int same = from;
    for (int i = to - 1; i > from && same == from; --i) same = x[i] == x[i - 1] ? from : i;
    equal[a] = to - same + (same == from && x[from] == last_[a] ? equal_[a] : 0);
  }
  for (int a = 0; a < kMaxAxes; ++a) {
    if ((block.axes_present >> a & 1U) == 0) continue;
    equal_[a] = equal[a];
    last_[a] = block.acceleration[a][to - 1];
  }
  return true;
}

void SampleCheck::forget_runs() noexcept {
  equal_.fill(0);
  full_.fill(0);
}

}  // namespace stillcut
