#include "drivers/can/decoder.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>

#include "dsp/numbers.hpp"

namespace stillcut {
namespace {

static_assert(std::endian::native == std::endian::little, "regular axes are loaded as they lie in the frame");

constexpr double kBeyondReason = 1e30;  // m/s^2; a floating-point sample may hold anything, also what no float can

// Physical value; NaN for a floating-point signal that is not finite.
double physical_value(const SignalPlan& signal, const std::uint8_t* data) noexcept {
  const std::uint64_t raw = read_bits(data, signal.bits);
  double value = 0.0;
  switch (signal.type) {
    case ValueType::unsigned_integer:
      value = static_cast<double>(raw);
      break;
    case ValueType::signed_integer:
      value = static_cast<double>(sign_extend(raw, signal.bits.length));
      break;
    case ValueType::float32:
      value = static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(raw)));
      break;
    case ValueType::float64:
      value = std::bit_cast<double>(raw);
      break;
  }
  return std::isfinite(value) ? value * signal.factor + signal.offset : kNaN;
}

std::uint64_t at_range_end(const SignalPlan& signal, double value) noexcept {
  return value <= signal.low || value >= signal.high ? 1 : 0;
}

// Fills values in m/s^2 and returns the full-scale bits.
std::uint64_t decode_axis(const AxisPlan& axis, double unit, const std::uint8_t* data, AxisValues& values) noexcept {
  const std::size_t n = axis.samples.size();
  std::uint64_t full_scale = 0;
  if (axis.regular) {
    const SignalPlan& signal = axis.samples.front();
    const std::uint8_t* from = data + axis.first_byte;
    for (std::size_t i = 0; i < n; ++i, from += axis.stride_bytes) {
      std::int16_t raw = 0;
      std::memcpy(&raw, from, sizeof raw);
      const double value = raw * signal.factor + signal.offset;
      full_scale |= at_range_end(signal, value) << i;
      values[i] = value * unit;
    }
    return full_scale;
  }
  for (std::size_t i = 0; i < n; ++i) {
    const double value = physical_value(axis.samples[i], data);
    full_scale |= at_range_end(axis.samples[i], value) << i;
    values[i] = std::abs(value * unit) < kBeyondReason ? value * unit : kNaN;
  }
  return full_scale;
}

// One tool axis from the sensor axes that contribute to it. Those that do not are left out of the sum: 0 * NaN is not
// 0.
void rotate_axis(const SensorPlan& sensor, std::size_t tool, const std::array<AxisValues, kMaxAxes>& values,
                 const std::array<std::uint64_t, kMaxAxes>& full_scale, SampleBlock& block) noexcept {
  AxisValues sum;
  std::fill_n(sum.begin(), sensor.samples, 0.0);
  block.full_scale[tool] = 0;
  for (std::size_t axis = 0; axis < kMaxAxes; ++axis) {
    const double share = sensor.rotation[tool][axis];
    if (share == 0.0) continue;
    for (std::size_t i = 0; i < static_cast<std::size_t>(sensor.samples); ++i) sum[i] += share * values[axis][i];
    block.full_scale[tool] |= full_scale[axis];
  }
  for (std::size_t i = 0; i < static_cast<std::size_t>(sensor.samples); ++i) {
    block.acceleration[tool][i] = static_cast<float>(sum[i]);
  }
}

bool multiplexed_away(const std::optional<MultiplexCondition>& condition, const CanFrame& frame) noexcept {
  return condition && frame.length >= bytes_needed(condition->bits) &&
         read_bits(frame.data.data(), condition->bits) != condition->value;
}

}  // namespace

Decoder::Decoder(const Dbc& dbc, const CanSettings& can, const std::string& cell_file)
    : plan_(compile_decode_plan(dbc, can, cell_file)) {}

bool Decoder::decode_sensor(const SensorPlan& sensor, Sequence& sequence, const CanFrame& frame,
                            Decoded& decoded) noexcept {
  if (multiplexed_away(sensor.multiplex, frame)) return false;
  if (frame.length < sensor.bytes) {
    decoded.bad = true;
    ++sequence.unread;
    return true;
  }
  SampleBlock& block = decoded.block[static_cast<std::size_t>(decoded.blocks)];
  if (sensor.counter) {
    const std::uint64_t now = read_bits(frame.data.data(), *sensor.counter);
    const std::uint64_t mask = bit_mask(sensor.counter->length);
    if (sequence.started && now == sequence.last) {
      decoded.bad = true;
      ++counters_.duplicates;
      return true;
    }
    const std::uint64_t lost = sequence.started ? (now - sequence.last - 1) & mask : 0;
    block.frames_lost =
        static_cast<std::uint32_t>(std::min<std::uint64_t>(lost, std::numeric_limits<std::uint32_t>::max()));
    sequence.started = true;
    sequence.last = now;
  } else {
    block.frames_lost = sequence.unread;
  }
  sequence.unread = 0;
  counters_.frames_lost += block.frames_lost;

  block.stamp_ns = frame.stamp_ns;
  block.sensor = sensor.sensor;
  block.axes_present = sensor.axes_present;
  block.samples = static_cast<std::uint8_t>(sensor.samples);
  std::array<std::uint64_t, kMaxAxes> full_scale{};
  for (std::size_t axis = 0; axis < kMaxAxes; ++axis) {
    if (sensor.axis[axis].samples.empty()) continue;
    full_scale[axis] = decode_axis(sensor.axis[axis], sensor.unit_m_per_s2, frame.data.data(), values_[axis]);
  }
  for (std::size_t tool = 0; tool < kMaxAxes; ++tool) {
    block.full_scale[tool] = 0;
    if ((sensor.axes_present >> tool & 1U) == 0) continue;
    if (sensor.rotated) {
      rotate_axis(sensor, tool, values_, full_scale, block);
      continue;
    }
    block.full_scale[tool] = full_scale[tool];
    for (std::size_t i = 0; i < static_cast<std::size_t>(sensor.samples); ++i) {
      block.acceleration[tool][i] = static_cast<float>(values_[tool][i]);
    }
  }
  ++decoded.blocks;
  return true;
}

bool Decoder::decode_spindle(const CanFrame& frame, Decoded& decoded) noexcept {
  const SpindlePlan& spindle = *plan_.spindle;
  if (multiplexed_away(spindle.multiplex, frame)) return false;
  const bool complete = frame.length >= spindle.bytes;
  const double rpm = complete ? physical_value(spindle.speed, frame.data.data()) : kNaN;
  decoded.spindle = {frame.stamp_ns, rpm * (2.0 * std::numbers::pi / 60.0)};
  decoded.has_speed = true;
  decoded.bad = decoded.bad || !complete;
  return true;
}

bool Decoder::decode(const CanFrame& frame, Decoded& decoded) noexcept {
  decoded.blocks = 0;
  decoded.has_speed = false;
  decoded.bad = false;
  bool ours = false;
  for (std::size_t i = 0; i < plan_.sensors.size(); ++i) {
    if (plan_.sensors[i].id == frame.id) ours |= decode_sensor(plan_.sensors[i], sequence_[i], frame, decoded);
  }
  if (plan_.spindle && plan_.spindle->id == frame.id) ours |= decode_spindle(frame, decoded);
  if (decoded.bad) ++counters_.frames_bad;
  return ours;
}

std::vector<std::uint32_t> Decoder::ids_used() const {
  std::vector<std::uint32_t> ids;
  for (const SensorPlan& sensor : plan_.sensors) ids.push_back(sensor.id);
  if (plan_.spindle) ids.push_back(plan_.spindle->id);
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  return ids;
}

}  // namespace stillcut
