// The samples of a window of time, sensor by sensor, evenly one after the other: what lies in the window of each block
// that a sensor sends, and how many samples are missing before it.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "drivers/files/cell.hpp"
#include "dsp/sample_clock.hpp"
#include "dsp/signals.hpp"

namespace stillcut {

// A stretch of one sensor's samples: `missing` lost ones, then `samples` that came. Either may be 0.
struct SampleStretch {
  int sensor = 0;        // index of the [[can.accelerometer]] table
  double begin_s = 0.0;  // of the first of them, missing ones too, since the first frame
  double step_s = 0.0;   // between samples
  std::int64_t missing = 0;
  int samples = 0;
  std::array<std::span<const float>, kMaxAxes> axis;  // m/s^2, views into the block; empty: not measured
};

class SampleWindow {
 public:
  // Samples from `from_s` on and before `to_s` (may be infinite), in seconds since the first frame.
  SampleWindow(std::span<const AccelerometerSettings> sensors, double from_s, double to_s);

  // What of the block, the next one of its sensor, lies in the window; nothing where nothing does. Times are those that
  // the monitor gives the samples: by the sensor's own rate, bounded by the frames' arrival. Each sensor's first
  // stretch begins with a sample or, where the window begins amid lost ones, with these; nothing is missing after the
  // last block.
  std::optional<SampleStretch> cut(const SampleBlock& block, std::int64_t origin_ns);

 private:
  struct Sensor {
    SampleClock clock;
    double step_s = 0.0;
  };
  double from_s_, to_s_;
  std::vector<Sensor> sensors_;
};

}  // namespace stillcut
