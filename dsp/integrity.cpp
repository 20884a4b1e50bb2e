#include "dsp/integrity.hpp"

#include <cmath>

namespace stillcut {
namespace {

// How many samples at the end are equal, given the sample before the first and how many were equal there.
int run_at_end(std::span<const Lanes> x, int lane, float before, int equal) noexcept {
  for (const Lanes& now : x) {
    equal = now[lane] == before ? equal + 1 : 1;
    before = now[lane];
  }
  return equal;
}

}  // namespace

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
    // A sensor may hold each value for two or three samples (a slower source behind it), and one of coarse resolution
    // repeats a value by chance some times more: eight equal ones were seen once in ten minutes. Sixteen are a stuck
    // sensor. Zeros are given longer: a coarse sensor at rest reads zero for a while.
    equal_[a] = x == last_[a] ? equal_[a] + 1 : 1;
    last_[a] = x;
    if (equal_[a] >= (x == 0.0F ? kZerosToBeDead : kEqualToBeStuck) && full_[a] == 0) doubts |= kStuck;
  }
  return doubts;
}

bool SampleCheck::beyond_doubt(const SampleBlock& block, std::span<const Lanes> x) noexcept {
  std::array<int, kMaxAxes> axis{};  // of each lane
  int axes = 0;
  Lanes before;
  for (int a = 0; a < kMaxAxes; ++a) {
    if ((block.axes_present >> a & 1U) == 0) continue;
    if (full_[a] != 0 || block.full_scale[a] != 0) return false;
    before.set(axes, last_[a]);
    axis[axes++] = a;
  }
  Lanes repeated, not_finite;
  const Lanes zero, one{1.0F};
  for (const Lanes& now : x) {
    repeated += where_equal(now, before, one, zero);
    not_finite += where_finite(now, zero, one);
    before = now;
  }
  // However they lie, this few equal neighbours make no run that is too long.
  for (int lane = 0; lane < axes; ++lane) {
    if (not_finite[lane] > 0.0F || equal_[axis[lane]] + repeated[lane] >= kEqualToBeStuck) return false;
  }
  for (int lane = 0; lane < axes; ++lane) {
    int& equal = equal_[axis[lane]];
    float& last = last_[axis[lane]];
    equal = repeated[lane] > 0.0F ? run_at_end(x, lane, last, equal) : 1;
    last = x.back()[lane];
  }
  return true;
}

void SampleCheck::forget_runs() noexcept {
  equal_.fill(0);
  full_.fill(0);
}

}  // namespace stillcut
