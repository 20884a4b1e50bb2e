// Recordings of hammer taps in a file, force and acceleration sampled together: universal files of time records, CSV,
// WAV. docs/tap-tests.md.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/files/uff58_file.hpp"
#include "models/tap_hits.hpp"

namespace stillcut {

struct HammerDirection {
  int axis = 0;        // x, y, z
  double sense = 1.0;  // -1: struck towards the axis' minus

  friend bool operator==(const HammerDirection&, const HammerDirection&) = default;
};

struct RecordedTaps {
  TapRecording recording;
  std::optional<HammerDirection> direction;  // where the file tells it: universal files alone do
};

struct TapFile {
  std::vector<RecordedTaps> taps;  // in the file's order
  std::vector<std::string> notes;  // what was assumed or left out, for the user
};

// What a channel of a WAV file is, and its value at digital full scale: N of force, m/s^2 of an acceleration.
enum class WavSignal { unused, force, x, y, z };
struct WavChannel {
  WavSignal signal = WavSignal::unused;
  double full_scale = 0.0;
};

// "force:2000N,x:500m/s^2,y:-50g,-": the channels in the file's order; a minus before the number turns the signal's
// sign, - alone is a channel that is not used. Throws std::invalid_argument, in words for the user, for what is
// neither, an unknown unit, no force, no acceleration, and a signal that is named twice.
[[nodiscard]] std::vector<WavChannel> parse_wav_channels(std::string_view text);

// By the name's ending: .uff or .unv, .csv, .wav; `channels` are those of WAV. Throws InputError.
[[nodiscard]] TapFile read_tap_file(const std::filesystem::path& file, std::span<const WavChannel> channels = {});

// Of the time records (function type 1) among the functions: force, and accelerations at one node, by their data types
// and directions. What repeats a channel begins another recording. Units by dataset 164 or by the axis' own label,
// otherwise SI, which a note says. Throws InputError with file and line of the function for complex numbers, rotations
// and open directions, a quantity that is neither force nor acceleration, unknown or contradicting units, times that
// are not even, channels of different rate or length, force without acceleration and the other way round, and a file
// without a time record.
[[nodiscard]] TapFile tap_file_of(const UffFile& content, const std::string& file);

// time_s, force_n and at least one of ax_m_per_s2, ay_m_per_s2, az_m_per_s2. Throws InputError with file and line for a
// column that lacks, a gap, a value that is no finite number, and times that are not even to half a step.
[[nodiscard]] TapRecording parse_tap_csv(std::string_view content, const std::string& file);

// `channels` in the file's order. Samples from 99 % of digital full scale on are overloads. Throws InputError for what
// is no WAV file or is cut off, for another number of channels, and for values that are not finite.
[[nodiscard]] TapRecording read_tap_wav(const std::filesystem::path& file, std::span<const WavChannel> channels);

// Time records in SI: force at node 1 along the hammer's direction, then the accelerations; one recording after the
// other. In binary the samples come back to the bit, a sample rate that is no whole number of Hz to six digits.
[[nodiscard]] UffFile uff_of(std::span<const TapRecording> recordings, HammerDirection hammer);

}  // namespace stillcut
