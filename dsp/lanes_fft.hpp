// Real forward FFT of up to four signals at once, one a lane: three axes for the price of one. As dsp/fft otherwise:
// tables are made once, transform() allocates nothing.
#pragma once

#include <complex>
#include <span>
#include <vector>

#include "dsp/lanes.hpp"

namespace stillcut {

struct ComplexLanes {
  Lanes re, im;

  friend ComplexLanes operator+(ComplexLanes a, ComplexLanes b) noexcept { return {a.re + b.re, a.im + b.im}; }
  friend ComplexLanes operator-(ComplexLanes a, ComplexLanes b) noexcept { return {a.re - b.re, a.im - b.im}; }
  friend ComplexLanes operator*(float a, ComplexLanes b) noexcept { return {a * b.re, a * b.im}; }
  friend ComplexLanes operator*(std::complex<float> a, ComplexLanes b) noexcept {
    return {a.real() * b.re - a.imag() * b.im, a.real() * b.im + a.imag() * b.re};
  }
  friend ComplexLanes times_minus_i(ComplexLanes a) noexcept { return {a.im, Lanes{} - a.re}; }
  friend ComplexLanes conjugate(ComplexLanes a) noexcept { return {a.re, Lanes{} - a.im}; }
};

class LanesFft {
 public:
  // length: even, its half a product of 2, 3 and 5; std::invalid_argument otherwise.
  explicit LanesFft(int length);

  [[nodiscard]] int length() const noexcept { return length_; }
  [[nodiscard]] int bins() const noexcept { return length_ / 2 + 1; }

  // Where to put the length() samples, even ones in re, odd ones in im. To be asked anew before each power().
  [[nodiscard]] std::span<ComplexLanes> pairs() noexcept { return work_; }
  // power[k] = |X[k]|^2 for first <= k <= last < bins(), X[k] = sum x[n] exp(-2 pi i k n / length).
  void power(int first, int last, std::span<Lanes> power) noexcept;

 private:
  struct Stage {
    int radix, length, stride;  // `stride` transforms of `length` points lie interleaved
    std::vector<std::complex<float>> twiddles;
  };

  int length_;
  std::vector<Stage> stages_;
  std::vector<ComplexLanes> work_, other_;
  std::vector<std::complex<float>> half_turns_;  // exp(-2 pi i k / length)
};

}  // namespace stillcut
