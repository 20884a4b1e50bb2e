#include "dsp/spindle_speed.hpp"

#include <algorithm>
#include <cmath>

namespace stillcut {
namespace {

constexpr std::int64_t kLongestExtension_ns = 60'000'000;  // further from the readings the speed is taken to be held
constexpr std::int64_t kOldestForSlope_ns = 250'000'000;   // readings further apart tell nothing about a ramp
constexpr double kMissFades_ns = 100e6;

}  // namespace

void SpindleSpeed::add(const SpindleReading& reading) noexcept {
  if (!std::isfinite(reading.speed)) return;
  const std::int64_t apart = reading.stamp_ns - last_.stamp_ns;
  if (readings_ > 0 && apart <= 0) return;
  if (readings_ > 0) {
    const double faded = missed_ * std::exp(-static_cast<double>(apart) / kMissFades_ns);
    missed_ = std::max(faded, std::abs(reading.speed - at(reading.stamp_ns)));
  }
  slope_ = readings_ > 0 && apart <= kOldestForSlope_ns
               ? (reading.speed - last_.speed) / (static_cast<double>(apart) * 1e-9)
               : 0.0;
  last_ = reading;
  readings_ = std::min(readings_ + 1, 2);
}

double SpindleSpeed::at(std::int64_t stamp_ns) const noexcept {
  if (readings_ == 0) return 0.0;
  const std::int64_t ahead =
      std::clamp<std::int64_t>(stamp_ns - last_.stamp_ns, -kLongestExtension_ns, kLongestExtension_ns);
  return last_.speed + slope_ * static_cast<double>(ahead) * 1e-9;
}
}  // namespace stillcut
