// The Hann window, and a line between the bins of its spectrum.
#pragma once

#include <cmath>
#include <cstddef>
#include <numbers>
#include <span>

#include "dsp/axes_fft.hpp"

namespace stillcut {

// Sample i of a Hann window of `length` samples, scaled so that a sine of amplitude 1 has a peak of 1 (0 dB).
[[nodiscard]] inline float hann_weight(std::size_t i, std::size_t length) noexcept {
  const double turn = static_cast<double>(i) / static_cast<double>(length);
  return static_cast<float>(2.0 * (1.0 - std::cos(2.0 * std::numbers::pi * turn)) / static_cast<double>(length));
}

// How three neighbouring bins share a line, and how to add them up again.
struct HannLine {
  std::size_t bin = 0;                          // the nearest
  float below = 0.0F, at = 0.0F, above = 0.0F;  // weights; a line of amplitude A at this place gives A

  // at_bin: its place in bins, at least 1 from both ends of the spectrum; window_length: samples of the transform.
  HannLine(double at_bin, int window_length) noexcept : bin{static_cast<std::size_t>(std::lround(at_bin))} {
    // sin(pi d) / (pi d (1 - d^2)) is the window's transform d bins from its middle.
    const double d = at_bin - static_cast<double>(bin), q = d * d * std::numbers::pi * std::numbers::pi;
    const double sinc = 1.0 - q / 6.0 * (1.0 - q / 20.0 * (1.0 - q / 42.0 * (1.0 - q / 72.0)));
    const double middle = sinc / (1.0 - d * d), left = sinc / ((1.0 + d) * (2.0 + d)),
                 right = sinc / ((1.0 - d) * (2.0 - d));
    // A bin's phase is that of the window's beginning; referred to its middle, neighbours alternate in sign.
    const double scale =
        (bin % 2 == 0 ? 4.0 : -4.0) / (window_length * (middle * middle + left * left + right * right));
    at = static_cast<float>(scale * middle);
    below = static_cast<float>(-scale * left);
    above = static_cast<float>(-scale * right);
  }

  // Complex amplitude of every axis, its phase that in the middle of the window.
  [[nodiscard]] ComplexLanes in(std::span<const ComplexLanes> spectrum) const noexcept {
    const ComplexLanes* const x = spectrum.data() + bin;
    return {at * x[0].re + below * x[-1].re + above * x[1].re, at * x[0].im + below * x[-1].im + above * x[1].im};
  }
};

}  // namespace stillcut
