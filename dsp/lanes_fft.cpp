// Stockham's algorithm with decimation in frequency: no bit reversal, every pass reads and writes in order. Two real
// samples make one complex value, which halves the length.
#include "dsp/lanes_fft.hpp"

#include <algorithm>
#include <array>
#include <numbers>
#include <stdexcept>
#include <utility>

namespace stillcut {
namespace {

constexpr double kMinusFullTurn = -2.0 * std::numbers::pi;

template <int kRadix>
using Values = std::array<ComplexLanes, kRadix>;

Values<2> butterfly(const Values<2>& x) noexcept { return {x[0] + x[1], x[0] - x[1]}; }

Values<3> butterfly(const Values<3>& x) noexcept {
  constexpr float kHalfRoot3 = 0.866025404F;
  const ComplexLanes sum = x[1] + x[2], turned = times_minus_i(kHalfRoot3 * (x[1] - x[2]));
  const ComplexLanes middle = x[0] - 0.5F * sum;
  return {x[0] + sum, middle + turned, middle - turned};
}

Values<4> butterfly(const Values<4>& x) noexcept {
  const ComplexLanes a = x[0] + x[2], b = x[0] - x[2], c = x[1] + x[3], d = times_minus_i(x[1] - x[3]);
  return {a + c, b + d, a - c, b - d};
}

Values<5> butterfly(const Values<5>& x) noexcept {
  constexpr float kCos1 = 0.309016994F, kCos2 = -0.809016994F, kSin1 = 0.951056516F, kSin2 = 0.587785252F;
  const ComplexLanes a = x[1] + x[4], b = x[2] + x[3], c = times_minus_i(x[1] - x[4]), d = times_minus_i(x[2] - x[3]);
  const ComplexLanes p = x[0] + kCos1 * a + kCos2 * b, q = x[0] + kCos2 * a + kCos1 * b;
  const ComplexLanes r = kSin1 * c + kSin2 * d, s = kSin2 * c - kSin1 * d;
  return {x[0] + a + b, p + r, q + s, q - s, p - r};
}

// One pass over all values: `apart` lies between the inputs of a butterfly, `stride` between its outputs.
template <int kRadix>
void pass(const ComplexLanes* from, ComplexLanes* to, int length, int stride,
          const std::complex<float>* twiddles) noexcept {
  const int steps = length / kRadix;
  const std::ptrdiff_t apart = std::ptrdiff_t{steps} * stride;
  for (int p = 0; p < steps; ++p, twiddles += kRadix - 1) {
    for (int q = 0; q < stride; ++q, ++from) {
      Values<kRadix> x;
      for (int j = 0; j < kRadix; ++j) x[j] = from[j * apart];
      const Values<kRadix> y = butterfly(x);
      ComplexLanes* const out = to + std::ptrdiff_t{p} * kRadix * stride + q;
      out[0] = y[0];
      if (p == 0) {
        for (int j = 1; j < kRadix; ++j) out[std::ptrdiff_t{j} * stride] = y[j];
      } else {
        for (int j = 1; j < kRadix; ++j) out[std::ptrdiff_t{j} * stride] = twiddles[j - 1] * y[j];
      }
    }
  }
}

}  // namespace

LanesFft::LanesFft(int length)
    : length_{length}, work_(std::max(0, length / 2)), other_(work_.size()), half_turns_(work_.size() + 1) {
  if (length < 4 || length % 2 != 0) throw std::invalid_argument("FFT length must be even");
  int rest = length / 2, stride = 1;
  for (const int radix : {5, 3, 4, 2}) {
    for (; rest % radix == 0; rest /= radix, stride *= radix) {
      Stage stage{radix, rest, stride, {}};
      for (int p = 0; p < rest / radix; ++p) {
        for (int j = 1; j < radix; ++j) {
          stage.twiddles.emplace_back(std::polar(1.0, kMinusFullTurn * p * j / rest));
        }
      }
      stages_.push_back(std::move(stage));
    }
  }
  if (rest != 1) throw std::invalid_argument("half of an FFT's length must be a product of 2, 3 and 5");
  for (std::size_t k = 0; k < half_turns_.size(); ++k) {
    half_turns_[k] = std::complex<float>{std::polar(1.0, kMinusFullTurn * static_cast<double>(k) / length)};
  }
}

void LanesFft::power(int first, int last, std::span<Lanes> power) noexcept {
  for (const Stage& s : stages_) {
    const auto run = s.radix == 5 ? pass<5> : s.radix == 4 ? pass<4> : s.radix == 3 ? pass<3> : pass<2>;
    run(work_.data(), other_.data(), s.length, s.stride, s.twiddles.data());
    std::swap(work_, other_);
  }
  // What the even samples give and what the odd ones give, apart again.
  const int half = length_ / 2;
  for (int k = first; k <= last; ++k) {
    const ComplexLanes z = work_[k < half ? k : 0], mirrored = conjugate(work_[k > 0 ? half - k : 0]);
    const ComplexLanes even = z + mirrored, odd = times_minus_i(z - mirrored);
    const ComplexLanes twice = even + half_turns_[k] * odd;
    power[k] = 0.25F * (twice.re * twice.re + twice.im * twice.im);
  }
}

}  // namespace stillcut
