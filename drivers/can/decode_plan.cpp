#include "drivers/can/decode_plan.hpp"

#include <algorithm>
#include <cmath>

#include "drivers/can/signal_reference.hpp"
#include "drivers/files/input_error.hpp"
#include "dsp/numbers.hpp"

namespace stillcut {
namespace {

constexpr std::array<const char*, kMaxAxes> kAxisNames = {"x", "y", "z"};

[[noreturn]] void fail(const CellKey& where, const std::string& message) {
  throw InputError(where.file, where.line, where.key + ": " + message);
}

// The ends of the range that raw values of this width have, then narrowed by the DBC's [min|max].
void set_range(SignalPlan& plan, const DbcSignal& signal) {
  plan.low = -kInfinity;
  plan.high = kInfinity;
  if (plan.type == ValueType::unsigned_integer || plan.type == ValueType::signed_integer) {
    const std::uint64_t all_ones = bit_mask(plan.bits.length);
    const bool is_signed = plan.type == ValueType::signed_integer;
    const double most = static_cast<double>(is_signed ? all_ones >> 1 : all_ones);
    const double least = is_signed ? -static_cast<double>((all_ones >> 1) + 1) : 0.0;
    const double one = least * plan.factor + plan.offset, other = most * plan.factor + plan.offset;
    plan.low = std::min(one, other);
    plan.high = std::max(one, other);
  }
  if (signal.minimum < signal.maximum) {
    plan.low = std::max(plan.low, signal.minimum);
    plan.high = std::min(plan.high, signal.maximum);
  }
}

SignalPlan plan_signal(const DbcSignal& signal) {
  SignalPlan plan;
  plan.bits = signal.bits;
  plan.type = signal.type;
  plan.factor = signal.factor;
  plan.offset = signal.offset;
  set_range(plan, signal);
  return plan;
}

// The one multiplexer value that all of these signals need; none when they are always present.
std::optional<MultiplexCondition> multiplex_condition(const DbcMessage& message,
                                                      const std::vector<const DbcSignal*>& signals,
                                                      const CellKey& where) {
  std::int64_t value = -1;
  for (const DbcSignal* signal : signals) {
    if (signal->multiplexed < 0) continue;
    if (value >= 0 && signal->multiplexed != value) {
      fail(where, "signals of message '" + message.name + "' that are sent by turns (multiplexed m" +
                      std::to_string(value) + " and m" + std::to_string(signal->multiplexed) +
                      ") cannot be read together; they must share one multiplexer value");
    }
    value = signal->multiplexed;
  }
  if (value < 0) return std::nullopt;
  const auto is_multiplexer = [](const DbcSignal& s) { return s.multiplexer; };
  if (std::count_if(message.signals.begin(), message.signals.end(), is_multiplexer) != 1) {
    fail(where, "message '" + message.name + "' needs exactly one multiplexer (M) to read multiplexed signals");
  }
  const auto multiplexer = std::find_if(message.signals.begin(), message.signals.end(), is_multiplexer);
  return MultiplexCondition{multiplexer->bits, static_cast<std::uint64_t>(value)};
}

int bytes_needed(const std::vector<const DbcSignal*>& signals, const std::optional<MultiplexCondition>& multiplex) {
  int bytes = multiplex ? bytes_needed(multiplex->bits) : 0;
  for (const DbcSignal* signal : signals) bytes = std::max(bytes, bytes_needed(signal->bits));
  return bytes;
}

AxisPlan plan_axis(const std::vector<const DbcSignal*>& signals) {
  AxisPlan axis;
  for (const DbcSignal* signal : signals) axis.samples.push_back(plan_signal(*signal));
  const SignalPlan& first = axis.samples.front();
  axis.first_byte = first.bits.start / 8;
  axis.stride_bytes = axis.samples.size() > 1 ? (axis.samples[1].bits.start - first.bits.start) / 8 : 2;
  axis.regular = true;
  for (std::size_t i = 0; i < axis.samples.size(); ++i) {
    const SignalPlan& s = axis.samples[i];
    axis.regular = axis.regular && s.bits.little_endian && s.bits.length == 16 &&
                   s.bits.start == 8 * (axis.first_byte + static_cast<int>(i) * axis.stride_bytes) &&
                   s.type == ValueType::signed_integer && s.factor == first.factor && s.offset == first.offset &&
                   s.low == first.low && s.high == first.high;
  }
  return axis;
}

// Which tool axes come out. One that the rotation mixes from measured and unmeasured sensor axes is not defined.
void plan_rotation(SensorPlan& sensor, const AccelerometerSettings& settings, const CellKey& where) {
  sensor.rotation = rotation_matrix(settings.rotation);
  for (std::size_t tool = 0; tool < kMaxAxes; ++tool) {
    bool measured = false, missing = false;
    for (std::size_t axis = 0; axis < kMaxAxes; ++axis) {
      const double share = sensor.rotation[tool][axis];
      if (share == 0.0) continue;
      (sensor.axis[axis].samples.empty() ? missing : measured) = true;
      sensor.rotated = sensor.rotated || axis != tool || share != 1.0;
    }
    if (measured && missing) {
      fail(where, std::string("rotation_deg mixes measured with unmeasured axes into tool ") + kAxisNames[tool] +
                      "; measure all three axes, or turn by quarter turns only");
    }
    if (measured) sensor.axes_present = static_cast<std::uint8_t>(sensor.axes_present | 1U << tool);
  }
}

SensorPlan plan_sensor(const Dbc& dbc, const AccelerometerSettings& settings, std::uint8_t index,
                       const CellKey& table) {
  SensorPlan sensor;
  sensor.sensor = index;
  sensor.unit_m_per_s2 = settings.unit_m_per_s2;
  const DbcMessage* message = nullptr;
  std::string first_key;
  std::vector<const DbcSignal*> all;
  const auto find = [&](const std::string& reference, const char* name) {
    const CellKey where{table.file, table.line, table.key + "." + name};
    SignalReference found = find_signals(dbc, reference, where);
    if (message != nullptr && found.message != message) {
      fail(where,
           "message '" + found.message->name + "' is not the one of " + first_key + ", '" + message->name +
               "'; axes and counter of one accelerometer come in one message: use a second [[can.accelerometer]]");
    }
    if (message == nullptr) first_key = name;
    message = found.message;
    all.insert(all.end(), found.signals.begin(), found.signals.end());
    return found.signals;
  };
  for (std::size_t i = 0; i < kMaxAxes; ++i) {
    if (settings.axis[i].empty()) continue;
    const char* key = settings.axis_keys[i].c_str();
    const std::vector<const DbcSignal*> signals = find(settings.axis[i], key);
    const int samples = static_cast<int>(signals.size());
    if (sensor.samples != 0 && samples != sensor.samples) {
      fail({table.file, table.line, table.key + "." + key}, std::to_string(samples) + " samples a frame, but " +
                                                                std::to_string(sensor.samples) + " for " + first_key +
                                                                "; all axes of an accelerometer have the same number");
    }
    sensor.samples = samples;
    sensor.axis[i] = plan_axis(signals);
  }
  if (message == nullptr) fail(table, "no axis is measured; give x, y or z");
  if (!settings.counter.empty()) {
    const std::vector<const DbcSignal*> signals = find(settings.counter, "counter");
    const ValueType type = signals.front()->type;
    if (signals.size() > 1 || type == ValueType::float32 || type == ValueType::float64) {
      fail({table.file, table.line, table.key + ".counter"}, "a counter is one whole number");
    }
    sensor.counter = signals.front()->bits;
  }
  sensor.id = message->id;
  sensor.multiplex = multiplex_condition(*message, all, table);
  sensor.bytes = bytes_needed(all, sensor.multiplex);
  plan_rotation(sensor, settings, table);
  return sensor;
}

SpindlePlan plan_spindle(const Dbc& dbc, const std::string& reference, const CellKey& where) {
  const SignalReference found = find_signals(dbc, reference, where);
  if (found.signals.size() > 1) fail(where, "the spindle speed is one signal");
  SpindlePlan spindle;
  spindle.id = found.message->id;
  spindle.speed = plan_signal(*found.signals.front());
  spindle.multiplex = multiplex_condition(*found.message, found.signals, where);
  spindle.bytes = bytes_needed(found.signals, spindle.multiplex);
  return spindle;
}

}  // namespace

std::array<std::array<double, 3>, 3> rotation_matrix(const std::array<double, 3>& angles) {
  const double ca = std::cos(angles[0]), sa = std::sin(angles[0]);
  const double cb = std::cos(angles[1]), sb = std::sin(angles[1]);
  const double cc = std::cos(angles[2]), sc = std::sin(angles[2]);
  std::array<std::array<double, 3>, 3> r = {{{cc * cb, cc * sb * sa - sc * ca, cc * sb * ca + sc * sa},
                                             {sc * cb, sc * sb * sa + cc * ca, sc * sb * ca - cc * sa},
                                             {-sb, cb * sa, cb * ca}}};
  for (auto& row : r) {
    for (double& entry : row) {
      const double nearest = std::round(entry);
      if (std::abs(entry - nearest) < 1e-12) entry = nearest;
    }
  }
  return r;
}

DecodePlan compile_decode_plan(const Dbc& dbc, const CanSettings& can, const std::string& cell_file) {
  if (can.accelerometers.size() > kMaxSensors) {
    fail({cell_file, can.accelerometers[kMaxSensors].line, "can.accelerometer"},
         std::to_string(can.accelerometers.size()) + " accelerometers; at most " + std::to_string(kMaxSensors));
  }
  DecodePlan plan;
  for (std::size_t i = 0; i < can.accelerometers.size(); ++i) {
    plan.sensors.push_back(plan_sensor(dbc, can.accelerometers[i], static_cast<std::uint8_t>(i),
                                       {cell_file, can.accelerometers[i].line, can.accelerometers[i].table}));
  }
  if (!can.spindle_speed.empty()) {
    plan.spindle = plan_spindle(dbc, can.spindle_speed, {cell_file, can.line, "can.spindle.speed_rpm"});
  }
  return plan;
}

}  // namespace stillcut
