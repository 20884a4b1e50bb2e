// Looks closely at one suspected chatter line: its frequency beyond the resolution of the FFT, and whether it grows,
// stands or fades within the window.
#pragma once

#include <span>

namespace stillcut {

struct Tone {
  double frequency_hz = 0.0;
  double amplitude = 0.0;     // of the last quarter of the window, unit of the samples
  double growth_per_s = 0.0;  // slope of the log amplitude over the window
  double rise = 0.0;          // amplitude of the last quarter over the largest of the quarters before
  double steadiness = 0.0;    // amplitude of the second quarter over that of the last: near 0 for a single knock
};

// samples: the newest window, oldest first, at least 64; near_hz: a first guess within 1.5 FFT bins of the line.
// The window is cut into eight pieces; each is mixed down to near_hz, and a line is fitted to phase and log amplitude.
Tone analyse_tone(std::span<const float> samples, double sample_rate_hz, double near_hz) noexcept;

// How the line near a frequency now stands to itself `lag_s` earlier, over two Hann windows of `length` samples.
struct Recurrence {
  double cycles = 0.0;  // phase turned beyond whole cycles, -0.5..0.5: 0 for whatever repeats after lag_s
  double before = 0.0;  // amplitude then over amplitude now
};

// samples: oldest first, at least `length` + lag_s in samples + 1.
Recurrence recurrence(std::span<const float> samples, int length, double sample_rate_hz, double near_hz,
                      double lag_s) noexcept;

// Offset in bins, -0.5..0.5 about, of a line from the largest bin of a Hann-windowed spectrum, from three magnitudes.
double hann_peak_offset(double before, double at, double after) noexcept;

}  // namespace stillcut
