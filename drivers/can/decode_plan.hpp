// The decode plan: for each accelerometer and for the spindle, which CAN identifier carries it, where its samples stand
// in the frame and what to multiply them with. Compiled once at start from the DBC file and the cell's [can] section,
// so that decoding a frame is arithmetic only.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "drivers/can/dbc.hpp"
#include "drivers/files/cell.hpp"
#include "rt/signals.hpp"

namespace stillcut {

// One number in a frame. physical = raw * factor + offset, as the DBC file says.
struct SignalPlan {
  BitField bits;
  ValueType type = ValueType::unsigned_integer;
  double factor = 1.0, offset = 0.0;
  double low = 0.0, high = 0.0;  // ends of its range (physical): raw extremes, or the DBC's [min|max] where narrower
};

// The message is meant only when the multiplexer has this value.
struct MultiplexCondition {
  BitField bits;
  std::uint64_t value = 0;
};

struct AxisPlan {
  std::vector<SignalPlan> samples;  // oldest first; empty: the sensor does not measure this axis
  // Whole, aligned, little-endian 16-bit samples at equal distances and of one scale: the usual layout, read in a plain
  // loop.
  bool regular = false;
  int first_byte = 0, stride_bytes = 0;
};

struct SensorPlan {
  std::uint32_t id = 0;
  std::uint8_t sensor = 0;  // index of the [[can.accelerometer]] table
  int samples = 0;          // per axis and frame
  int bytes = 0;            // a shorter frame is bad
  double unit_m_per_s2 = 1.0;
  std::array<AxisPlan, kMaxAxes> axis;
  bool rotated = false;
  std::array<std::array<double, kMaxAxes>, kMaxAxes> rotation{};  // [tool axis][sensor axis]
  std::uint8_t axes_present = 0;                                  // tool axes, bit 0 x
  std::optional<BitField> counter;
  std::optional<MultiplexCondition> multiplex;
};

struct SpindlePlan {
  std::uint32_t id = 0;
  int bytes = 0;
  SignalPlan speed;  // rpm
  std::optional<MultiplexCondition> multiplex;
};

struct DecodePlan {
  std::vector<SensorPlan> sensors;
  std::optional<SpindlePlan> spindle;
};

// Sensor to tool frame: the sensor's vector is turned about the fixed axes x, then y, then z (rad): Rz * Ry * Rx.
// Entries within 1e-12 of 0 and +-1 are made exact, so that quarter turns swap axes without mixing them.
std::array<std::array<double, 3>, 3> rotation_matrix(const std::array<double, 3>& angles);

// Throws InputError that names the cell file, the line of the table and the key: a message or signal that the DBC lacks
// (and those with the nearest names), axes of one accelerometer in different messages or of different length, more
// samples than a block holds, a rotation that mixes measured axes with unmeasured ones.
DecodePlan compile_decode_plan(const Dbc& dbc, const CanSettings& can, const std::string& cell_file);

}  // namespace stillcut
