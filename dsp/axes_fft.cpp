#include "dsp/axes_fft.hpp"

#include <complex>
#include <kissfft.hh>
#include <numbers>
#include <vector>

#include "dsp/fft.hpp"

namespace stillcut {

// The scalar that the library's template reckons with: a number of every axis.
struct AxesScalar {
  Lanes::Four v{};
  AxesScalar() = default;
  AxesScalar(float all) noexcept : v{all, all, all, all} {}
  AxesScalar(Lanes::Four four) noexcept : v{four} {}
  AxesScalar operator-() const noexcept { return -v; }
  AxesScalar& operator+=(AxesScalar b) noexcept { return v += b.v, *this; }
  AxesScalar& operator-=(AxesScalar b) noexcept { return v -= b.v, *this; }
  AxesScalar& operator*=(AxesScalar b) noexcept { return v *= b.v, *this; }
  friend AxesScalar operator+(AxesScalar a, AxesScalar b) noexcept { return a.v + b.v; }
  friend AxesScalar operator-(AxesScalar a, AxesScalar b) noexcept { return a.v - b.v; }
  friend AxesScalar operator*(AxesScalar a, AxesScalar b) noexcept { return a.v * b.v; }
};

}  // namespace stillcut

// The library finds its angles with std::acos and std::exp, which know no lanes; the rest of it is good for any scalar.
template <>
inline kissfft<stillcut::AxesScalar>::kissfft(const std::size_t nfft, const bool inverse)
    : _nfft{nfft}, _inverse{inverse} {
  for (std::size_t i = 0; i < nfft; ++i) {
    const double angle = 2.0 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(nfft);
    const std::complex<double> turn = std::polar(1.0, inverse ? angle : -angle);
    _twiddles.push_back({static_cast<float>(turn.real()), static_cast<float>(turn.imag())});
  }
  std::size_t left = nfft;
  for (const std::size_t radix : {4U, 2U, 3U, 5U}) {
    for (; left % radix == 0 && left > 1; left /= radix) {
      _stageRadix.push_back(radix);
      _stageRemainder.push_back(left / radix);
    }
  }
}

namespace stillcut {

// A real transform is one of half the length over pairs of samples, and a last step that parts even from odd.
struct AxesFft::Plan {
  explicit Plan(int length)
      : half{static_cast<std::size_t>(length / 2)}, fft{half, false}, pairs(half), paired(half), turns(half + 1) {
    for (std::size_t k = 0; k <= half; ++k) {
      const double angle = -std::numbers::pi * static_cast<double>(k) / static_cast<double>(half);
      turns[k] = {static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle))};
    }
  }
  std::size_t half;
  kissfft<AxesScalar> fft;
  std::vector<std::complex<AxesScalar>> pairs, paired;
  std::vector<std::complex<float>> turns;
};

AxesFft::AxesFft(int length) {
  require_fft_length(length);
  plan_ = std::make_unique<Plan>(length);
}

AxesFft::~AxesFft() = default;
AxesFft::AxesFft(AxesFft&&) noexcept = default;
AxesFft& AxesFft::operator=(AxesFft&&) noexcept = default;

void AxesFft::transform(std::span<const Lanes> input, std::span<ComplexLanes> output) noexcept {
  Plan& plan = *plan_;
  const std::size_t half = plan.half;
  for (std::size_t k = 0; k < half; ++k) plan.pairs[k] = {input[2 * k].v, input[2 * k + 1].v};
  plan.fft.transform(plan.pairs.data(), plan.paired.data());
  for (std::size_t k = 0; k <= half; ++k) {
    const std::complex<AxesScalar>&at = plan.paired[k == half ? 0 : k], &mirror = plan.paired[k == 0 ? 0 : half - k];
    const Lanes even_re = 0.5F * (at.real().v + mirror.real().v), even_im = 0.5F * (at.imag().v - mirror.imag().v),
                odd_re = 0.5F * (at.imag().v + mirror.imag().v), odd_im = 0.5F * (mirror.real().v - at.real().v);
    const float c = plan.turns[k].real(), s = plan.turns[k].imag();
    output[k] = {even_re + c * odd_re - s * odd_im, even_im + c * odd_im + s * odd_re};
  }
}

}  // namespace stillcut
