// From CAN frames to samples: the decoder turns each frame into acceleration in the tool frame (m/s^2) and spindle
// speed (rad/s), tells how many frames a sensor has lost, and marks samples that stand at the end of the sensor's
// range.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "drivers/can/decode_plan.hpp"
#include "rt/can_frame.hpp"
#include "rt/signals.hpp"

namespace stillcut {

using AxisValues = std::array<double, kMaxSamplesPerBlock>;  // m/s^2, oldest first

// What one frame held. Usually one block or one reading; a frame may carry several sensors, and the speed too.
struct Decoded {
  int blocks = 0;          // how many of `block` were filled, in the order of the cell's [[can.accelerometer]] tables
  bool has_speed = false;  // `spindle` was filled
  bool bad = false;        // the frame is one of ours but could not be used, or was there already
  std::array<SampleBlock, kMaxSensors> block;  // of the samples, only [axis present][0 .. samples) are filled
  SpindleReading spindle;
};

struct DecoderCounters {
  std::int64_t frames_lost = 0;  // missing, by the sensors' counters
  std::int64_t frames_bad = 0;   // too short for their signals, or doubled
  std::int64_t duplicates = 0;   // of these: the counter stood still
};

// One thread. Holds no clock: the same frames give the same blocks, bit for bit.
//
// The counter: the first frame of a sensor has nothing lost. After that, (counter - last - 1) modulo 2^width frames are
// lost; a sensor that restarts looks like a loss of that many. A counter that stands still means the same frame twice:
// the second is bad and not delivered. Without a counter only frames too short to be read count as lost. Range: a
// sample at or beyond the end of its raw range, or of the DBC's [min|max] unless that is 0|0, sets its full-scale bit;
// in a rotated sensor the bit shows on every tool axis that the sample contributes to. Floating-point samples that are
// not finite become NaN, and so does the speed; a speed frame too short gives NaN and is bad.
class Decoder {
 public:
  // Throws InputError, see compile_decode_plan. `cell_file` is named in messages.
  Decoder(const Dbc& dbc, const CanSettings& can, const std::string& cell_file);

  // Returns whether the frame is one of ours (then see `decoded`). Real-time: no allocation, no lock, no system call.
  bool decode(const CanFrame& frame, Decoded& decoded) noexcept;

  // Identifiers with CanFrame::kExtended where they have 29 bits, ascending: what a bus needs to let through.
  [[nodiscard]] std::vector<std::uint32_t> ids_used() const;

  [[nodiscard]] const DecoderCounters& counters() const noexcept { return counters_; }
  [[nodiscard]] const DecodePlan& plan() const noexcept { return plan_; }

 private:
  struct Sequence {
    bool started = false;
    std::uint64_t last = 0;
    std::uint32_t unread = 0;  // frames too short since the last block, for sensors without a counter
  };
  bool decode_sensor(const SensorPlan& sensor, Sequence& sequence, const CanFrame& frame, Decoded& decoded) noexcept;
  bool decode_spindle(const CanFrame& frame, Decoded& decoded) noexcept;

  DecodePlan plan_;
  std::array<Sequence, kMaxSensors> sequence_{};
  std::array<AxisValues, kMaxAxes> values_{};  // sensor axes of the frame at hand
  DecoderCounters counters_;
};

}  // namespace stillcut
