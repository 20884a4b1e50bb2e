// Hammer taps heard on the CAN bus: frames of the accelerometer and of the hammer become samples side by side, and each
// hit is judged as soon as its record is over.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "drivers/can/decoder.hpp"
#include "drivers/files/cell.hpp"
#include "models/tap_hits.hpp"

namespace stillcut {

// Throws InputError for a cell without hammer.
const HammerSettings& require_hammer(const Cell& cell);

// The hammer as decoders and encoders take it: a sensor with a single axis, whose m/s^2 are N.
[[nodiscard]] AccelerometerSettings hammer_as_sensor(const HammerSettings& hammer);

struct HeardTap {
  TapRecording recording;  // of this hit alone
  double peak_n = 0.0;
  std::string refusal;  // why it cannot be used and what to do; empty: it is sound
};

// Hammer and accelerometer must be sampled by one clock and fill their frames in step: how late a frame arrives says
// nothing, so the stamps only tell which frames belong together (docs/tap-tests.md).
class TapListener {
 public:
  // `sensor` counts the cell's [[can.accelerometer]] tables from 0. The ends of the ranges that the cell tells go into
  // `settings` where they are lower. Throws InputError for a cell without hammer, without that sensor, or with another
  // sample rate of the two, and as compile_decode_plan does; std::invalid_argument for settings out of range.
  TapListener(const Cell& cell, std::size_t sensor, const TapSettings& settings);

  [[nodiscard]] std::vector<std::uint32_t> ids_used() const { return decoder_.ids_used(); }
  [[nodiscard]] double sample_rate_hz() const { return rate_hz_; }
  [[nodiscard]] const TapSettings& settings() const { return settings_; }

  // One frame of the bus, in the order of arrival. The hit whose record is over with it.
  std::optional<HeardTap> add(const CanFrame& frame);

  // Towards which the next hits go.
  void set_direction(int axis, double sense);

  // What was heard so far is of no interest.
  void restart();

  // Blocks of samples since the beginning: of the accelerometer, of the hammer.
  [[nodiscard]] std::array<std::int64_t, 2> blocks() const { return blocks_; }

 private:
  enum Side : std::uint8_t { kResponse, kForce };
  struct Block {
    std::int64_t end = 0;  // index of the sample after its last
    std::int64_t stamp_ns = 0;
  };
  struct Stream {
    std::int64_t begin = 0, end = 0;  // of the samples kept
    std::array<std::deque<double>, kMaxAxes> values;
    std::deque<std::int64_t> overloads;
    std::deque<Block> blocks;
  };

  void append(Side side, const SampleBlock& block);
  [[nodiscard]] std::int64_t response_lead() const;
  [[nodiscard]] TapRecording cut_out(std::int64_t force_begin, std::int64_t length, std::int64_t lead) const;
  std::optional<HeardTap> next_hit();
  static void drop_before(Stream& stream, std::int64_t index);
  void forget_old();

  TapSettings settings_;
  Decoder decoder_;
  double rate_hz_ = 0.0;
  std::int64_t length_ = 0, before_ = 0;  // of a record, samples
  int step_ = 0;                          // samples by which the streams can be apart
  std::array<bool, kMaxAxes> measured_{};
  std::array<Stream, 2> streams_;
  std::array<std::int64_t, 2> blocks_{};
  std::int64_t scanned_ = 0;         // force samples before it are no beginning of a hit
  std::optional<std::int64_t> hit_;  // force sample that reached the trigger
  Decoded decoded_;
};

}  // namespace stillcut
