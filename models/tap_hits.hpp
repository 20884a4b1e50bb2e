// Hammer hits in a recording of force and acceleration: where they are, and which of them a frequency response can be
// estimated from. What is not fit for it says why. docs/tap-tests.md.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "dsp/numbers.hpp"

namespace stillcut {

// Sampled together, from one rest to the next: one hit or several.
struct TapRecording {
  double sample_rate_hz = 0.0;
  std::vector<double> force;                        // N, pressing is positive
  std::array<std::vector<double>, 3> acceleration;  // m/s^2 along x, y, z; empty: not measured
  // Samples at which force, or any acceleration, stood at the end of its instrument's range, rising; where the
  // instrument tells.
  std::vector<std::size_t> force_overloads, response_overloads;
};

inline constexpr double kEndOfRange = 0.99;  // of full scale: amplifiers bend before they clip

struct TapSettings {
  int force_axis = 0;                                   // x, y, z
  double force_sense = 1.0;                             // -1: struck towards the axis' minus
  double record_s = 1.0;                                // what is transformed of each hit
  double before_s = 0.01;                               // of that, before the force rises
  double trigger_n = 20.0;                              // a force from here up is a hit, well above its noise
  double least_peak_n = 100.0;                          // a hit weaker than this tells too little
  double rebound_share = 0.05;                          // of the peak: a second pulse above it is a double hit
  double force_full_scale_n = kInfinity;                // of the hammer; infinite: not known, no overload is seen
  double acceleration_full_scale_m_per_s2 = kInfinity;  // of the sensor, likewise
  double force_window_s = 0.02;                         // after the force rises; infinite: none
  double end_weight = 0.01;                             // of the exponential window at the record's end; 1: none
  double highest_of_rate = 0.4;                         // frequencies up to this share of the sample rate
};

enum class TapFault : std::uint8_t {
  none,
  force_overload,
  response_overload,
  double_hit,
  too_long,
  too_weak,
  cut_off,
};

// Why a hit is left out and what to do, e.g. "double hit: let the hammer rebound freely".
[[nodiscard]] const char* describe(TapFault fault) noexcept;

struct TapHit {
  std::size_t recording = 0;  // which of several
  std::size_t at = 0;         // sample at which the force reaches the trigger
  double peak_n = 0.0;
  TapFault fault = TapFault::none;
};

// Samples of a record: no more than asked for, even, a product of 2, 3 and 5; and of those, before the trigger.
[[nodiscard]] std::size_t record_samples(const TapSettings& settings, double sample_rate_hz);
[[nodiscard]] std::size_t samples_before(const TapSettings& settings, double sample_rate_hz);

// Throws std::invalid_argument, in words for the operator, for settings out of their range.
void require_tap_settings(const TapSettings& settings);

// The same, and for channels of different
// length, values that are not finite, a channel that is zero throughout, and a force that points the wrong way.
void require_sound_taps(const TapRecording& recording, const TapSettings& settings);

// Every hit in turn, the bad ones with their fault; none where the force stays below the trigger. A hit that follows
// another within its record is part of that one's fault, as the structure still moves. The recording and the settings
// are sound.
[[nodiscard]] std::vector<TapHit> find_hits(const TapRecording& recording, const TapSettings& settings);

}  // namespace stillcut
