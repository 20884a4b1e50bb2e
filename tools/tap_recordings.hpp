// Recordings of taps as a command line names them, sorted by the hammer's direction.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "drivers/files/tap_recording_file.hpp"

namespace stillcut {

// x, y, z, also with a sign; nothing for anything else.
[[nodiscard]] std::optional<HammerDirection> parse_direction(std::string text);

struct RecordedDirection {
  HammerDirection hammer;
  std::vector<TapRecording> recordings;
  std::vector<std::string> files;  // of each recording
};

struct NamedRecordings {
  std::vector<std::string> names;                    // FILE, or x=FILE where the file does not tell the hammer's axis
  double sense = 1.0;                                // of those that are named with their axis
  std::optional<HammerDirection> default_direction;  // where neither name nor file tells
  std::vector<WavChannel> channels;                  // of WAV files
};

// In the order in which the directions first appear; what was assumed of the files goes to `notes`. Throws InputError
// for what read_tap_file() refuses, a recording whose direction nobody tells, a file that tells another one than its
// name, and recordings of both senses of an axis.
[[nodiscard]] std::vector<RecordedDirection> read_directions(const NamedRecordings& named,
                                                             std::vector<std::string>& notes);

}  // namespace stillcut
