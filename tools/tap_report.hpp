// What an operator is told of estimated frequency responses: how far up the hammer excites, and how well the hits
// agree.
#pragma once

#include <array>
#include <iosfwd>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "drivers/files/tap_recording_file.hpp"
#include "models/tap_estimate.hpp"

namespace stillcut {

struct AxisQuality {
  bool measured = false;
  double coherence = kNaN;  // mean over the lines that the hammer excites; NaN of a single hit
  double doubtful = kNaN;   // share of them where it is below 0.9
};

struct TapQuality {
  double excited_to_hz = 0.0;  // up to here the force is at least a tenth of its strongest
  std::array<AxisQuality, 3> axes;
};

[[nodiscard]] TapQuality quality_of(const TapEstimate& estimate);

// One line on the force and one on coherence, and what to do where it is low.
void print_quality(const TapEstimate& estimate, HammerDirection hammer, std::ostream& out);

// A hit a line, e.g. "  at 2.134 s  812 N  sound"; `files` name the recordings.
void print_hits(const TapEstimate& estimate, const std::vector<std::string>& files,
                const std::vector<TapRecording>& recordings, std::ostream& out);

// axis, sense, hits, hits_used, resolution_hz, excited_to_hz, added_decay_per_s, coherence.
[[nodiscard]] nlohmann::ordered_json taps_to_json(const TapEstimate& estimate, HammerDirection hammer,
                                                  const std::vector<std::string>& files,
                                                  const std::vector<TapRecording>& recordings);

}  // namespace stillcut
