// Spindle speed at any sample, from speed messages that come far less often. Between messages the last two readings are
// extended for a short time and then held, so that a ramp costs nothing and a late message does no harm.
#pragma once

#include <cstdint>

#include "dsp/signals.hpp"

namespace stillcut {

class SpindleSpeed {
 public:
  // A new reading; a non-finite one is ignored here (the monitor reports it).
  void add(const SpindleReading& reading) noexcept;

  // Speed at a time, rad/s; 0 before the first reading.
  [[nodiscard]] double at(std::int64_t stamp_ns) const noexcept;

  [[nodiscard]] bool has_reading() const noexcept { return readings_ > 0; }
  [[nodiscard]] std::int64_t last_stamp_ns() const noexcept { return last_.stamp_ns; }

  // By how much recent readings missed what was extended to their stamps, rad/s: near 0 at constant speed and on an
  // even ramp, large where a ramp begins or ends and where stamps jitter.
  [[nodiscard]] double uncertainty() const noexcept { return missed_; }

 private:
  SpindleReading last_{};
  double slope_ = 0.0;   // rad/s^2 between the last two readings
  double missed_ = 0.0;  // rad/s
  int readings_ = 0;
};

}  // namespace stillcut
