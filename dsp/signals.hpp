// What the monitor takes and gives, as plain values: decoded sensor samples and spindle speed in, events out. Every
// type is trivially copyable, so it passes through a ring. Times are nanoseconds on the CAN stamps' clock; other
// quantities are SI (m, s, rad) unless the name says otherwise.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>
#include <type_traits>

namespace stillcut {

inline constexpr int kMaxAxes = 3;              // x, y, z of one accelerometer
inline constexpr int kMaxSamplesPerBlock = 64;  // an FD frame holds at most 64 one-byte samples
inline constexpr int kMaxSensors = 4;           // accelerometers in a cell

// The samples of one sensor frame, oldest first. The stamp is that of the last sample; earlier ones lie 1/rate apart.
struct SampleBlock {
  std::int64_t stamp_ns = 0;
  std::uint8_t sensor = 0;        // index of the [[can.accelerometer]] table
  std::uint8_t axes_present = 0;  // bit 0 x, bit 1 y, bit 2 z
  std::uint8_t samples = 0;
  std::uint32_t frames_lost = 0;                     // frames missing before this one, told by the sensor's counter
  std::array<std::uint64_t, kMaxAxes> full_scale{};  // bit i: sample i stands at the end of its range
  std::array<std::array<float, kMaxSamplesPerBlock>, kMaxAxes> acceleration{};  // m/s^2, in tool axes; may hold NaN
};

struct SpindleReading {
  std::int64_t stamp_ns = 0;
  double speed = 0.0;  // rad/s; NaN when the message could not be read
};

enum class EventType : std::int8_t {
  cut_entry = 1,
  cut_exit = 2,
  chatter_onset = 3,
  chatter_end = 4,
  correction = 5,
  fault = 6,
  forced_vibration = 7
};
enum class ChatterKind : std::int8_t { unknown = 0, regenerative = 1, structural = 2 };
enum class State : std::int8_t {
  idle = 0,
  air = 1,
  entry = 2,
  cut = 3,
  exit = 4,
  chatter = 5,
  cannot_tell = 6,
  fault = 7
};
using ShortText = std::array<char, 96>;  // zero-terminated; holds a note or a reason without the heap

// Truncates to what fits; keeps the terminating zero.
constexpr ShortText short_text(std::string_view text) {
  ShortText out{};
  for (std::size_t i = 0; i + 1 < out.size() && i < text.size(); ++i) out[i] = text[i];
  return out;
}

// The text as far as it goes.
inline std::string_view text_of(const ShortText& text) {
  return {text.data(), static_cast<std::size_t>(std::find(text.begin(), text.end(), '\0') - text.begin())};
}

struct Event {
  std::int64_t stamp_ns = 0;  // stamp of the newest sample used when it was decided
  EventType type = EventType::fault;
  ChatterKind kind = ChatterKind::unknown;
  double frequency_hz = 0.0;       // NaN: not applicable
  double indicator = 0.0;          // 1 is the alarm limit; NaN: not applicable
  double spindle_speed_rpm = 0.0;  // measured; in `correction` the target
  ShortText note{};
};

static_assert(std::is_trivially_copyable_v<SampleBlock> && std::is_trivially_copyable_v<Event>);

}  // namespace stillcut
