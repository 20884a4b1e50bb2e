#include "dsp/fft.hpp"

#include <kiss_fftr.h>

#include <stdexcept>

namespace stillcut {
namespace {

bool has_only_small_factors(int n) {
  for (const int factor : {2, 3, 5}) {
    while (n % factor == 0) n /= factor;
  }
  return n == 1;
}

kiss_fftr_state* make_plan(int length) {
  require_fft_length(length);
  return kiss_fftr_alloc(length, 0, nullptr, nullptr);
}

}  // namespace

void require_fft_length(int length) {
  if (length < 4 || length % 2 != 0 || !has_only_small_factors(length)) {
    throw std::invalid_argument("FFT length must be even and a product of 2, 3 and 5");
  }
}

RealFft::RealFft(int length)
    : length_{length}, plan_{make_plan(length), [](kiss_fftr_state* p) { kiss_fftr_free(p); }} {
  if (!plan_) throw std::bad_alloc();
}

void RealFft::transform(std::span<const float> input, std::span<std::complex<float>> output) noexcept {
  static_assert(sizeof(kiss_fft_cpx) == sizeof(std::complex<float>));
  kiss_fftr(plan_.get(), input.data(), reinterpret_cast<kiss_fft_cpx*>(output.data()));
}

}  // namespace stillcut
