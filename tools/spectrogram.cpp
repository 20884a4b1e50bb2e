#include "tools/spectrogram.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "dsp/fft.hpp"
#include "dsp/hann_line.hpp"

namespace stillcut {

plot::Image spectrogram(std::span<const float> signal, double sample_rate_hz, double start_s, double window_s,
                        double highest_hz, int max_columns) {
  constexpr double kShownDb = 60.0;
  // The power of two nearest to the window asked for.
  const std::size_t length =
      std::bit_floor(static_cast<std::size_t>(std::max(64.0, std::numbers::sqrt2 * window_s * sample_rate_hz)));
  plot::Image image;
  image.scale_label = "dB re 1 m/s²";
  if (signal.size() < length || max_columns < 1) return image;

  const std::size_t last_begin = signal.size() - length;
  const std::size_t hop = std::max(length / 8, last_begin / static_cast<std::size_t>(max_columns) + 1);
  const double bin_hz = sample_rate_hz / static_cast<double>(length);
  RealFft fft(static_cast<int>(length));
  image.columns = static_cast<int>(last_begin / hop) + 1;
  image.rows = std::min(static_cast<int>(std::ceil(highest_hz / bin_hz)) + 1, fft.bins());
  image.values.resize(static_cast<std::size_t>(image.columns) * static_cast<std::size_t>(image.rows));

  std::vector<float> window(length), windowed(length);
  for (std::size_t i = 0; i < length; ++i) window[i] = hann_weight(i, length);
  std::vector<std::complex<float>> spectrum(static_cast<std::size_t>(fft.bins()));
  double strongest = -200.0;
  for (int column = 0; column < image.columns; ++column) {
    const float* part = &signal[static_cast<std::size_t>(column) * hop];
    for (std::size_t i = 0; i < length; ++i) windowed[i] = std::isfinite(part[i]) ? part[i] * window[i] : 0.0F;
    fft.transform(windowed, spectrum);
    for (int row = 0; row < image.rows; ++row) {
      const double level =
          20.0 * std::log10(static_cast<double>(std::abs(spectrum[static_cast<std::size_t>(row)])) + 1e-10);
      image.values[static_cast<std::size_t>(row * image.columns + column)] = static_cast<float>(level);
      if (row > 4) strongest = std::max(strongest, level);  // not the sensor's offset and drift
    }
  }
  image.high = std::ceil(strongest / 10.0) * 10.0;
  image.low = image.high - kShownDb;
  const double first_middle = start_s + 0.5 * static_cast<double>(length) / sample_rate_hz;
  const double step = static_cast<double>(hop) / sample_rate_hz;
  image.x_begin = first_middle - 0.5 * step;
  image.x_end = image.x_begin + step * image.columns;
  image.y_begin = -0.5 * bin_hz;  // a value stands for the band around its own frequency
  image.y_end = (image.rows - 0.5) * bin_hz;
  return image;
}

}  // namespace stillcut
