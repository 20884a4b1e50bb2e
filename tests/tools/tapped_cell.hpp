// The demo cell's structure tapped, for the tests of the guided tap test: frames of simulated taps, and the truth.
#pragma once

#include <complex>
#include <span>
#include <vector>

#include "drivers/files/dynamics_map_file.hpp"
#include "models/frequency_response.hpp"
#include "models/machining.hpp"
#include "tests/tools/run_program.hpp"
#include "tools/simulated_taps.hpp"

namespace stillcut {

inline Cell tapped_demo_cell() { return read_cell(EXAMPLES "/demo-cell/cell.toml", {.map = false, .bus = false}); }

inline std::vector<Mode> home_modes() { return read_dynamics_map(EXAMPLES "/demo-cell/map").postures.front().modes; }

inline std::vector<CanFrame> frames_of_taps(const Cell& cell, std::span<const SimulatedTap> taps,
                                            const SimulatedTapping& tapping = {}) {
  std::vector<CanFrame> frames;
  simulate_taps(cell, home_modes(), taps, tapping, [&](const CanFrame& frame) { frames.push_back(frame); });
  return frames;
}

// The closed form at p = i w + s, from the definition of Mode: what an exponential window leaves of the structure.
inline std::complex<double> shifted_receptance(std::span<const Mode> modes, std::size_t response, std::size_t force,
                                               double frequency_hz, double added_decay_per_s) {
  const std::complex<double> p(added_decay_per_s, kTwoPi * frequency_hz);
  std::complex<double> sum;
  for (const Mode& mode : modes) {
    const double w = mode.natural_frequency;
    sum += mode.direction[response] * mode.direction[force] * w * w /
           (mode.stiffness * (p * p + 2.0 * mode.damping_ratio * w * p + w * w));
  }
  return sum;
}

// Of a column, the response to force along `force`: the largest, over the resonances named, of the deviation within 20
// % of the resonance, root mean square over its lines and measured axes, over the column's peak there.
inline double off_at_resonances(const FrequencyResponse& found, std::span<const Mode> modes, std::size_t force,
                                const std::vector<std::size_t>& resonances) {
  double worst = 0.0;
  for (const std::size_t resonance : resonances) {
    double peak = 0.0, sum = 0.0, values = 0.0;
    for (std::size_t i = 0; i < found.frequencies_hz.size(); ++i) {
      const double hz = found.frequencies_hz[i];
      if (std::abs(kTwoPi * hz / modes[resonance].natural_frequency - 1.0) > 0.2) continue;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        if (found.receptance[axis][force].empty()) continue;
        const auto truth = shifted_receptance(modes, axis, force, hz, found.added_decay_per_s);
        peak = std::max(peak, std::abs(truth));
        sum += std::norm(found.receptance[axis][force][i] - truth);
        ++values;
      }
    }
    worst = std::max(worst, values > 0.0 ? std::sqrt(sum / values) / peak : kInfinity);
  }
  return worst;
}

// Of the demo cell: those that a hammer along x and one along y excites. Along z it hardly moves, and what a sensor of
// 16 bits leaves of that is no test of anything.
inline const std::vector<std::size_t> kAlongXResonances{0, 2, 4}, kAlongYResonances{1, 3, 5};

}  // namespace stillcut
