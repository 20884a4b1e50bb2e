#include "dsp/fft.hpp"

#include <fftw3.h>
#include <gtest/gtest.h>

#include <complex>
#include <random>
#include <stdexcept>
#include <vector>

#include "dsp/axes_fft.hpp"

namespace stillcut {
namespace {

TEST(RealFft, AgreesWithFftwInDoublePrecision) {
  for (const int length : {8, 64, 256, 640, 1000, 1250, 2048, 5000}) {
    std::mt19937 random{static_cast<unsigned>(length)};
    std::normal_distribution<float> normal;
    std::vector<float> input(static_cast<std::size_t>(length));
    for (float& x : input) x = normal(random);

    std::vector<double> in(input.begin(), input.end());
    RealFft fft{length};
    const auto bins = static_cast<std::size_t>(fft.bins());
    std::vector<std::complex<double>> expected(bins);
    fftw_plan plan = fftw_plan_dft_r2c_1d(length, in.data(), reinterpret_cast<fftw_complex*>(expected.data()),
                                          FFTW_ESTIMATE | FFTW_PRESERVE_INPUT);
    fftw_execute(plan);
    fftw_destroy_plan(plan);

    std::vector<std::complex<float>> output(bins);
    fft.transform(input, output);
    double error = 0.0, size = 0.0;
    for (std::size_t k = 0; k < bins; ++k) {
      error += std::norm(std::complex<double>{output[k]} - expected[k]);
      size += std::norm(expected[k]);
    }
    EXPECT_LT(std::sqrt(error / size), 5e-7) << length;
  }
}

TEST(AxesFft, GivesEveryAxisWhatItWouldGetAlone) {
  for (const int length : {4, 8, 10, 30, 64, 256, 640, 1000, 1250, 2048, 5000}) {
    std::mt19937 random{static_cast<unsigned>(length)};
    std::normal_distribution<float> normal;
    std::vector<Lanes> input(static_cast<std::size_t>(length));
    for (Lanes& x : input) x = {normal(random), 10.0F * normal(random), 0.0F, normal(random)};
    AxesFft all{length};
    RealFft one{length};
    std::vector<ComplexLanes> output(static_cast<std::size_t>(one.bins()));
    all.transform(input, output);
    for (int a = 0; a < Lanes::kCount; ++a) {
      std::vector<float> axis;
      for (const Lanes& x : input) axis.push_back(x[a]);
      std::vector<std::complex<float>> expected(output.size());
      one.transform(axis, expected);
      double error = 0.0, size = 1e-12;
      for (std::size_t k = 0; k < output.size(); ++k) {
        error += std::norm(std::complex<float>{output[k].re[a], output[k].im[a]} - expected[k]);
        size += std::norm(expected[k]);
      }
      EXPECT_LT(std::sqrt(error / size), 1e-6) << length << ", axis " << a;
    }
  }
}

TEST(RealFft, RefusesLengthsThatItWouldHaveToAllocateFor) {
  for (const int length : {0, 2, 7, 15, 14, 22, 1026, -8}) {
    EXPECT_THROW(RealFft{length}, std::invalid_argument) << length;
    EXPECT_THROW(AxesFft{length}, std::invalid_argument) << length;
  }
}

}  // namespace
}  // namespace stillcut
