// Where a signal's vibration lies over time and frequency: short-time Fourier transform for pictures, not for
// decisions.
#pragma once

#include <span>

#include "tools/plot.hpp"

namespace stillcut {

// Amplitudes in dB re 1 m/s² up to `highest_hz`, over windows (Hann) about `window_s` long, at most `max_columns` of
// them. The colours cover the 60 dB below the strongest line. NaN samples count as silence. Empty (no columns) for a
// signal shorter than a window.
plot::Image spectrogram(std::span<const float> signal, double sample_rate_hz, double start_s, double window_s,
                        double highest_hz, int max_columns = 1200);

}  // namespace stillcut
