// A structure whose truth is known, struck by a simulated hammer.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <complex>
#include <cstddef>
#include <random>
#include <span>
#include <vector>

#include "models/machining.hpp"
#include "models/modal_structure.hpp"
#include "models/tap_hits.hpp"

namespace stillcut {

struct HammerPulse {
  double at_s, peak_n, duration_s;

  double force(double time_s) const {
    const double share = (time_s - at_s) / duration_s;
    if (share <= 0.0 || share >= 1.0) return 0.0;
    const double sine = std::sin(0.5 * kTwoPi * share);
    return peak_n * sine * sine;
  }
};

// Stepped far finer than sampled: the structure is exact for a force that is straight within a step.
inline TapRecording tapped(std::span<const Mode> modes, std::size_t force_axis, double force_sense,
                           std::span<const HammerPulse> pulses, double seconds, double sample_rate_hz) {
  constexpr int kSteps = 16;
  const double step = 1.0 / (kSteps * sample_rate_hz);
  const auto samples = static_cast<std::size_t>(std::llround(seconds * sample_rate_hz));
  const auto force_at = [&](double time_s) {
    double sum = 0.0;
    for (const HammerPulse& pulse : pulses) sum += pulse.force(time_s);
    return sum;
  };
  ModalStructure structure(modes, step);
  TapRecording recording;
  recording.sample_rate_hz = sample_rate_hz;
  Eigen::Vector3d begin = Eigen::Vector3d::Zero(), end = begin;
  const auto axis = static_cast<Eigen::Index>(force_axis);
  for (std::size_t n = 0; n < samples; ++n) {
    recording.force.push_back(force_sense * begin[axis]);
    for (std::size_t i = 0; i < 3; ++i)
      recording.acceleration[i].push_back(structure.acceleration()[static_cast<Eigen::Index>(i)]);
    for (std::size_t k = 1; k <= kSteps; ++k, begin = end) {
      end[axis] = force_sense * force_at(static_cast<double>(n * kSteps + k) * step);
      structure.advance(begin, end);
    }
  }
  return recording;
}

// The closed form, from the definition of Mode.
inline std::complex<double> receptance_between(std::span<const Mode> modes, std::size_t response, std::size_t force,
                                               double frequency_hz) {
  std::complex<double> sum;
  for (const Mode& mode : modes) {
    const double r = kTwoPi * frequency_hz / mode.natural_frequency;
    sum += mode.direction[response] * mode.direction[force] / mode.stiffness /
           std::complex<double>(1.0 - r * r, 2.0 * mode.damping_ratio * r);
  }
  return sum;
}

// The same record `times` over, each with its own white noise; the structure is at rest between them.
inline TapRecording repeated_with_noise(const TapRecording& once, int times, double force_noise_n,
                                        double acceleration_noise, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  TapRecording all;
  all.sample_rate_hz = once.sample_rate_hz;
  for (int i = 0; i < times; ++i) {
    for (const double value : once.force) all.force.push_back(value + force_noise_n * normal(random));
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (const double value : once.acceleration[axis])
        all.acceleration[axis].push_back(value + acceleration_noise * normal(random));
  }
  return all;
}

}  // namespace stillcut
