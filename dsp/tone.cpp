#include "dsp/tone.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>

namespace stillcut {
namespace {

constexpr int kPieces = 8;
using Pieces = std::array<std::complex<double>, kPieces>;

// Mean of each eighth of the window after mixing down: a short complex envelope of the line.
Pieces mix_down(std::span<const float> samples, double radians_per_sample) noexcept {
  Pieces pieces{};
  const std::size_t length = samples.size() / kPieces;
  const std::complex<double> turn = std::polar(1.0, -radians_per_sample);
  std::size_t n = samples.size() - length * kPieces;
  for (int p = 0; p < kPieces; ++p) {
    std::complex<double> phasor = std::polar(1.0, -radians_per_sample * static_cast<double>(n));
    std::complex<double> sum{};
    for (std::size_t i = 0; i < length; ++i, ++n) {
      sum += static_cast<double>(samples[n]) * phasor;
      phasor *= turn;
    }
    pieces[p] = 2.0 * sum / static_cast<double>(length);
  }
  return pieces;
}

// Slope per piece of a line through y, weighted.
double weighted_slope(const std::array<double, kPieces>& y, const std::array<double, kPieces>& weight) noexcept {
  double w = 0, wx = 0, wy = 0, wxx = 0, wxy = 0;
  for (int i = 0; i < kPieces; ++i) {
    w += weight[i];
    wx += weight[i] * i;
    wy += weight[i] * y[i];
    wxx += weight[i] * i * i;
    wxy += weight[i] * i * y[i];
  }
  const double spread = w * wxx - wx * wx;
  return spread > 0.0 ? (w * wxy - wx * wy) / spread : 0.0;
}

}  // namespace

Tone analyse_tone(std::span<const float> samples, double sample_rate_hz, double near_hz) noexcept {
  const double two_pi = 2.0 * std::numbers::pi;
  const Pieces pieces = mix_down(samples, two_pi * near_hz / sample_rate_hz);
  std::array<double, kPieces> power{}, phase{}, log_amplitude{};
  double largest = 0.0;
  for (int p = 0; p < kPieces; ++p) {
    power[p] = std::norm(pieces[p]);
    largest = std::max(largest, power[p]);
  }
  if (!(largest > 0.0)) return {near_hz, 0.0, 0.0, 0.0, 0.0};
  for (int p = 0; p < kPieces; ++p) {
    log_amplitude[p] = 0.5 * std::log(std::max(power[p], 1e-8 * largest));
    phase[p] = std::arg(pieces[p]);
    if (p > 0) phase[p] = phase[p - 1] + std::remainder(phase[p] - phase[p - 1], two_pi);
  }
  const std::size_t piece = samples.size() / kPieces;
  const double piece_s = static_cast<double>(piece) / sample_rate_hz;

  std::array<double, 4> quarter{};
  for (int q = 0; q < 4; ++q) quarter[q] = std::sqrt(0.5 * (power[2 * q] + power[2 * q + 1]));

  Tone tone;
  tone.frequency_hz = near_hz + weighted_slope(phase, power) / (two_pi * piece_s);
  tone.growth_per_s = weighted_slope(log_amplitude, power) / piece_s;
  tone.amplitude = quarter[3];
  const double before = std::max({quarter[0], quarter[1], quarter[2]});
  tone.rise = before > 0.0 ? quarter[3] / before : 0.0;
  tone.steadiness = quarter[3] > 0.0 ? quarter[1] / quarter[3] : 0.0;
  return tone;
}

Recurrence recurrence(std::span<const float> samples, int length, double sample_rate_hz, double near_hz,
                      double lag_s) noexcept {
  const double two_pi = 2.0 * std::numbers::pi;
  const auto lag = static_cast<std::size_t>(std::lround(lag_s * sample_rate_hz));
  const float* const now = samples.data() + (samples.size() - static_cast<std::size_t>(length));
  const float* const then = now - lag;
  const std::complex<double> turn = std::polar(1.0, -two_pi * near_hz / sample_rate_hz);
  const std::complex<double> window_turn = std::polar(1.0, two_pi / length);
  std::complex<double> phasor = 1.0, window_phasor = 1.0, at_now{}, at_then{};
  for (int n = 0; n < length; ++n) {
    const std::complex<double> weighted = (0.5 - 0.5 * window_phasor.real()) * phasor;
    at_now += static_cast<double>(now[n]) * weighted;
    at_then += static_cast<double>(then[n]) * weighted;
    phasor *= turn;
    window_phasor *= window_turn;
  }
  if (!(std::norm(at_now) > 0.0)) return {};
  // The lag in whole samples misses lag_s by a fraction, through which the line itself has turned.
  const double missed = (lag_s - static_cast<double>(lag) / sample_rate_hz) * near_hz;
  const double cycles = std::arg(at_now * std::conj(at_then)) / two_pi + missed;
  return {cycles - std::round(cycles), std::sqrt(std::norm(at_then) / std::norm(at_now))};
}

double hann_peak_offset(double before, double at, double after) noexcept {
  const double sum = before + 2.0 * at + after;
  return sum > 0.0 ? 2.0 * (after - before) / sum : 0.0;
}

}  // namespace stillcut
