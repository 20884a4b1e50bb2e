// A planned cut, milled in simulation: what its accelerometer and spindle drive send, and the truth about it.
#pragma once

#include <vector>

#include "dsp/numbers.hpp"
#include "dsp/signals.hpp"
#include "tests/bench/detection/cut_plan.hpp"
#include "tests/bench/detection/tip_truth.hpp"

namespace stillcut::detection {

inline constexpr std::int64_t kOrigin_ns = 1'000'000'000'000;

struct CutTruth {
  double forced = 0.0;                      // m, amplitude at the last depth
  double tenth_s = kNaN, visible_s = kNaN;  // tool chatter at 10 % and 50 % of it; NaN: never
  double slow_s = kNaN;                     // structural: its acceleration stands at 3 x the noise in 2-100 Hz
  double noise = 0.0;                       // m/s^2, standard deviation of a sample
  double snr_db = 0.0;                      // the plan's, or better where structural chatter would not be heard
  std::vector<double> amplitude;            // m, tool chatter, every millisecond
  TipMotion motion;
};

struct MilledCut {
  std::vector<SampleBlock> blocks;            // as sent; lost ones are missing and counted by the next
  std::vector<SpindleReading> readings;       // rising stamps
  std::vector<std::array<float, 2>> samples;  // x and y as measured, the lost ones as well
  std::vector<double> turns;                  // spindle revolutions at each sample
  CutTruth truth;
};

MilledCut mill(const CutPlan& plan);

// The two lines that a plan may grow.
TipLine tool_line(const CutPlan& plan);
TipLine slow_line(const CutPlan& plan);

}  // namespace stillcut::detection
