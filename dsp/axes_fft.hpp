// Real forward FFT of all axes of a sensor at once, a lane an axis, of a fixed length. Plans and buffers are made once;
// transform() allocates nothing.
#pragma once

#include <memory>
#include <span>

#include "dsp/lanes.hpp"

namespace stillcut {

struct ComplexLanes {
  Lanes re, im;
};

class AxesFft {
 public:
  // length: see require_fft_length in dsp/fft.hpp
  explicit AxesFft(int length);
  ~AxesFft();
  AxesFft(AxesFft&&) noexcept;
  AxesFft& operator=(AxesFft&&) noexcept;

  // input: a lane-wise sample for each n < length; output: length / 2 + 1 values, X[k] = sum x[n] exp(-2 pi i k n /
  // length). Not for two threads at once.
  void transform(std::span<const Lanes> input, std::span<ComplexLanes> output) noexcept;

 private:
  struct Plan;
  std::unique_ptr<Plan> plan_;
};

}  // namespace stillcut
