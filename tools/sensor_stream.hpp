// One accelerometer for onlookers: its spectrum, its samples thinned out, its health. For pictures and not for
// decisions: what is decided upon comes from the monitor. One ordinary thread.
#pragma once

#include <array>
#include <complex>
#include <cstdint>
#include <vector>

#include "drivers/lcm/telemetry_messages.hpp"
#include "dsp/fft.hpp"
#include "dsp/signals.hpp"

namespace stillcut {

class SensorStream {
 public:
  SensorStream(int sensor, double sample_rate_hz, int teeth);

  void add(const SampleBlock& block);

  // Of the last 0.16 s; no levels before so much was heard, and none again before more is.
  [[nodiscard]] SpectrumReport spectrum(double spindle_hz);
  // The thinned samples since the last call, oldest first, at most as many as a report holds.
  [[nodiscard]] VibrationReport take_vibration();
  [[nodiscard]] const SensorHealth& health() const { return health_; }

 private:
  static constexpr double kWindow_s = 0.16, kThinned_hz = 200.0, kHighest_hz = 5000.0;

  void push(const std::array<float, kMaxAxes>& sample, std::int64_t stamp_ns);
  void thin_out(std::int64_t stamp_ns);
  void watch_rate(const SampleBlock& block);

  // Sample counts at two moments of the sensor's life, ten to twenty seconds apart once it is old enough.
  struct Mark {
    std::int64_t stamp_ns = 0, samples = 0;
  };

  int sensor_, teeth_;
  double rate_hz_;
  std::size_t length_;                                // of the window, samples
  std::vector<std::array<float, kMaxAxes>> history_;  // round and round, `length_` long; NaN: lost or not measured
  std::size_t next_ = 0;                              // where in it the next sample goes
  std::int64_t heard_ = 0;                            // samples so far, with those lost
  std::int64_t shown_ = 0;                            // of them at the last spectrum
  std::vector<float> window_, axis_;
  std::vector<std::complex<float>> bins_;
  RealFft fft_;
  int thinning_;               // samples to one thinned
  std::vector<float> kernel_;  // weights of those that make one
  int until_thinned_;
  VibrationReport vibration_;
  SensorHealth health_;
  Mark first_, second_;
};

}  // namespace stillcut
