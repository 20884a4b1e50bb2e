// Hammer taps on a structure whose modes are known, as sensors and hammer would send them on the CAN bus: to learn the
// tap test, and to try it, without a robot.
#pragma once

#include <cstdint>
#include <functional>
#include <iosfwd>
#include <span>
#include <string>

#include "drivers/files/cell.hpp"
#include "drivers/files/tap_recording_file.hpp"
#include "models/dynamics_map.hpp"
#include "rt/can_frame.hpp"

namespace stillcut {

struct SimulatedTap {
  HammerDirection hammer;
  double peak_n = 800.0;
  double duration_s = 0.002;  // of a sine-squared pulse
  double rebound_n = 0.0;     // peak of a second pulse, 30 ms later; 0: none
};

struct SimulatedTapping {
  double spacing_s = 2.0;  // from one hit to the next; the first comes after half of it
  double acceleration_noise_m_per_s2 = 0.02, force_noise_n = 0.1;  // white, rms
  std::uint64_t seed = 1;
  std::int64_t origin_ns = 1'700'000'000'000'000'000;  // stamp of time 0
};

// Frames in the order of their stamps go to `send`. Samples are means over their interval, of force and acceleration
// alike, as the filters of one recorder leave them. Throws InputError for a cell without hammer, for a hammer that
// shares its message with an accelerometer, and as compile_decode_plan does.
void simulate_taps(const Cell& cell, std::span<const Mode> modes, std::span<const SimulatedTap> taps,
                   const SimulatedTapping& tapping, const std::function<void(const CanFrame&)>& send);

// At postures of the cell's map, one after the other, as a candump log; `progress` is told the share done, 0 to 1.
// Returns how many frames. Throws InputError for a posture that the map does not know, too.
std::int64_t write_simulated_taps(const Cell& cell, std::span<const std::string> postures,
                                  std::span<const SimulatedTap> taps, SimulatedTapping tapping, std::ostream& out,
                                  const std::function<void(double)>& progress);

}  // namespace stillcut
