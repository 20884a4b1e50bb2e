// The guided tap test: asks for hits along one direction, tells of each what became of it, and lets the operator decide
// on what came out. No bus and no terminal of its own, so that it can be tried with a recording and written answers.
#pragma once

#include <functional>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "drivers/files/tap_recording_file.hpp"
#include "models/tap_estimate.hpp"
#include "tools/tap_listener.hpp"

namespace stillcut {

struct TapSource {
  std::function<HeardTap()> next;  // waits for the next hit; throws where none can come any more
  std::function<void()> forget;    // what was heard while nobody was asked to hit
};

struct TapQuestion {
  std::string posture;
  HammerDirection hammer;
  int hits = 5;  // sound ones
};

struct TappedDirection {
  HammerDirection hammer;
  std::vector<TapRecording> recordings;  // a sound hit each
  TapEstimate estimate;
};

[[nodiscard]] std::string direction_name(HammerDirection hammer);  // x, -z

// Asks until the operator accepts; nothing where the operator quits or `answers` end. `settings` but its direction.
[[nodiscard]] std::optional<TappedDirection> ask_for_taps(const TapQuestion& question, TapSettings settings,
                                                          const TapSource& source, std::istream& answers,
                                                          std::ostream& out);

}  // namespace stillcut
