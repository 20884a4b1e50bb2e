// Real forward FFT of a fixed length. Plans and buffers are made once; transform() allocates nothing.
#pragma once

#include <complex>
#include <memory>
#include <span>

struct kiss_fftr_state;

namespace stillcut {

// Even, a product of 2, 3 and 5 (other factors would allocate while running); std::invalid_argument otherwise.
void require_fft_length(int length);

class RealFft {
 public:
  // length: see require_fft_length
  explicit RealFft(int length);

  [[nodiscard]] int length() const noexcept { return length_; }
  [[nodiscard]] int bins() const noexcept { return length_ / 2 + 1; }

  // input: length() samples; output: bins() values, X[k] = sum x[n] exp(-2 pi i k n / length). Not for two threads at
  // once.
  void transform(std::span<const float> input, std::span<std::complex<float>> output) noexcept;

 private:
  int length_;
  std::unique_ptr<kiss_fftr_state, void (*)(kiss_fftr_state*)> plan_;
};

}  // namespace stillcut
