// What a correction may ask of this cell: the range of spindle speeds that spindle, tool and drive allow, how fast each
// quantity may move, how far feed and feed direction may leave the program. Plain values, SI units.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>

#include "models/machining.hpp"

namespace stillcut {

struct SpeedBand {
  double low = 0.0, high = 0.0;  // rad/s
};

struct CompensationLimits {
  static constexpr std::size_t kMaxBands = 8;

  SpindleLimits spindle;                 // its range already narrowed to the tool's window of cutting speed
  double spindle_time_constant_s = 0.3;  // of the spindle behind the controller: how long a correction needs to act
  std::array<SpeedBand, kMaxBands> avoided{};  // dead zones: passed, never stayed in
  std::size_t avoided_count = 0;

  double feed_per_tooth = 0.0;  // m, as programmed; 0: unknown
  double min_feed_per_tooth = 0.0, max_feed_per_tooth = std::numeric_limits<double>::infinity();  // m, tool's window
  double min_feed_override = 0.5, max_feed_override = 2.0;  // what the controller takes; 1 = programmed
  double feed_override_rate = 1.0;                          // per second, back off; recovered slower

  double free_turn = 0.0;  // rad, to both sides of the programmed feed direction; 0: the path leaves it no freedom
  double turn_rate = 0.5;  // rad/s

  double max_variation = 0.2;  // amplitude over mean of a spindle speed variation; 0: the spindle cannot
  double max_variation_hz = 2.0;
  bool may_stop = true;  // a stop request is the last resort
};

// May the spindle stay at this speed (rad/s)? False for NaN.
[[nodiscard]] inline bool may_stay_at(const CompensationLimits& limits, double speed) noexcept {
  if (!(speed >= limits.spindle.min_speed && speed <= limits.spindle.max_speed)) return false;
  return std::none_of(limits.avoided.begin(),
                      limits.avoided.begin() + static_cast<std::ptrdiff_t>(limits.avoided_count),
                      [&](const SpeedBand& band) { return speed > band.low && speed < band.high; });
}

// The feed override that keeps the programmed feed per tooth when the spindle turns at `speed` instead of
// `programmed_speed` (rad/s), as far as the controller takes it.
[[nodiscard]] inline double override_for(const CompensationLimits& limits, double speed,
                                         double programmed_speed) noexcept {
  return std::clamp(speed / programmed_speed, limits.min_feed_override, limits.max_feed_override);
}

// Does the feed per tooth stay in the tool's window at that speed? Where the override is held up by its range the feed
// per tooth changes. True where the programmed feed per tooth is not known or lies outside the window itself.
[[nodiscard]] inline bool keeps_feed_per_tooth(const CompensationLimits& limits, double speed,
                                               double programmed_speed) noexcept {
  const double programmed = limits.feed_per_tooth;
  if (!(programmed >= limits.min_feed_per_tooth && programmed <= limits.max_feed_per_tooth)) return true;
  const double feed = programmed * override_for(limits, speed, programmed_speed) * programmed_speed / speed;
  constexpr double kRounding = 1e-9;
  return feed >= limits.min_feed_per_tooth * (1.0 - kRounding) && feed <= limits.max_feed_per_tooth * (1.0 + kRounding);
}

}  // namespace stillcut
