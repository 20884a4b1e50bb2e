// The detectors that the benchmark compares, each on the same samples of the same cut: the suite's own monitor, and
// four simple ones that are in use or in print. The simple ones are told by the plan when the tool is in the cut.
#pragma once

#include <array>
#include <string_view>
#include <vector>

#include "tests/bench/detection/milled_cut.hpp"

namespace stillcut::detection {

enum class Detector : std::uint8_t { monitor, level, once_per_revolution, energy_ratio, fft };
inline constexpr std::size_t kDetectors = 5;
inline constexpr std::array<std::string_view, kDetectors> kDetectorNames{"monitor", "level", "once per revolution",
                                                                         "energy ratio", "FFT"};

inline constexpr double kTrack_s = 0.01;

struct Alarm {             // an episode
  double time = 0.0;       // s, of the newest sample used
  double end = kInfinity;  // s, when it was over
  ChatterKind kind = ChatterKind::unknown;
  bool called_regenerative = false, called_structural = false;  // then or later in the episode
  double frequency_hz = kNaN, after_25ms_hz = kNaN, after_250ms_hz = kNaN;
  std::vector<double> track_hz;  // structural: what was heard every kTrack_s from the alarm on
};

std::vector<Alarm> ask_monitor(const CutPlan& plan, const MilledCut& cut);
std::vector<Alarm> ask_level(const CutPlan& plan, const MilledCut& cut);
std::vector<Alarm> ask_once_per_revolution(const CutPlan& plan, const MilledCut& cut);
std::vector<Alarm> ask_energy_ratio(const CutPlan& plan, const MilledCut& cut);
std::vector<Alarm> ask_fft(const CutPlan& plan, const MilledCut& cut);

}  // namespace stillcut::detection
