#include "tools/can_encoder.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "models/machining.hpp"

namespace stillcut {
namespace {

constexpr int kSpindleCycleMs = 20;  // where the DBC file tells none

// The raw number whose decoding comes nearest to `value`, which is inside the signal's range.
std::uint64_t raw_of(const SignalPlan& signal, double value) {
  const double raw = (value - signal.offset) / signal.factor;
  switch (signal.type) {
    case ValueType::float32:
      return std::bit_cast<std::uint32_t>(static_cast<float>(raw));
    case ValueType::float64:
      return std::bit_cast<std::uint64_t>(raw);
    case ValueType::signed_integer: {
      const double largest = std::ldexp(1.0, signal.bits.length - 1);
      return static_cast<std::uint64_t>(
          static_cast<std::int64_t>(std::clamp(std::round(raw), -largest, largest - 1.0)));
    }
    default:
      return static_cast<std::uint64_t>(std::clamp(std::round(raw), 0.0, std::ldexp(1.0, signal.bits.length) - 1.0));
  }
}

void select(CanFrame& frame, const std::optional<MultiplexCondition>& multiplex) {
  if (multiplex) write_bits(frame.data.data(), multiplex->bits, multiplex->value);
}

// What a sensor sends instead of `value`; all in its unit.
double faulty(const std::optional<SensorFault>& fault, double value, double last, const SignalPlan& signal,
              double unit_m_per_s2) {
  if (!fault) return value;
  switch (fault->kind) {
    case SensorFaultKind::stuck:
      return last;
    case SensorFaultKind::saturated:
      return signal.high;
    case SensorFaultKind::offset:
      return value + fault->offset / unit_m_per_s2;
    case SensorFaultKind::nan:
      return std::nan("");
    case SensorFaultKind::dead:
      return 0.0;
    case SensorFaultKind::silent:
      break;
  }
  return value;
}

}  // namespace

CanEncoder::CanEncoder(const Dbc& dbc, const CanSettings& can, const std::string& cell_file, SensorNoise noise,
                       std::int64_t origin_ns)
    : plan_{compile_decode_plan(dbc, can, cell_file)}, noise_{noise}, random_{noise.seed}, origin_ns_{origin_ns} {
  for (const SensorPlan& plan : plan_.sensors) {
    Sensor sensor;
    sensor.plan = plan;
    sensor.message = frame_of(dbc, plan.id);
    sensor.sample_rate_hz = can.accelerometers[plan.sensor].sample_rate_hz;
    sensors_.push_back(sensor);
  }
  if (plan_.spindle) {
    spindle_frame_ = frame_of(dbc, plan_.spindle->id);
    const auto message = std::find_if(dbc.messages.begin(), dbc.messages.end(),
                                      [&](const DbcMessage& m) { return m.id == plan_.spindle->id; });
    spindle_period_ = 1e-3 * (message->cycle_time_ms > 0 ? message->cycle_time_ms : kSpindleCycleMs);
  }
}

std::size_t CanEncoder::frame_of(const Dbc& dbc, std::uint32_t id) {
  for (std::size_t i = 0; i < frames_.size(); ++i)
    if (frames_[i].id == id) return i;
  const auto message =
      std::find_if(dbc.messages.begin(), dbc.messages.end(), [&](const DbcMessage& m) { return m.id == id; });
  CanFrame frame;
  frame.id = id;
  frame.length = static_cast<std::uint8_t>(message->length);
  frame.fd = message->fd;
  frame.fd_flags = message->fd ? 1 : 0;  // data at the faster bit rate, as sensors send
  frames_.push_back(frame);
  return frames_.size() - 1;
}

void CanEncoder::put(CanFrame& frame, const SignalPlan& signal, double value) {
  write_bits(frame.data.data(), signal.bits, raw_of(signal, std::clamp(value, signal.low, signal.high)));
}

void CanEncoder::send(std::size_t message, double time) {
  frames_[message].stamp_ns = origin_ns_ + 1000 * static_cast<std::int64_t>(std::llround(time * 1e6));
  due_.push_back(frames_[message]);
}

bool CanEncoder::can_send_nan() const {
  const auto is_float = [](const SignalPlan& signal) {
    return signal.type == ValueType::float32 || signal.type == ValueType::float64;
  };
  return std::all_of(plan_.sensors.begin(), plan_.sensors.end(), [&](const SensorPlan& sensor) {
    return std::all_of(sensor.axis.begin(), sensor.axis.end(), [&](const AxisPlan& axis) {
      return std::all_of(axis.samples.begin(), axis.samples.end(), is_float);
    });
  });
}

bool CanEncoder::is_sensor_frame(const CanFrame& frame) const {
  return std::any_of(plan_.sensors.begin(), plan_.sensors.end(),
                     [&](const SensorPlan& sensor) { return sensor.id == frame.id; });
}

void CanEncoder::sample(Sensor& sensor, const Eigen::Vector3d& velocity) {
  const Eigen::Vector3d tool_acceleration = (velocity - sensor.velocity) * sensor.sample_rate_hz;
  sensor.velocity = velocity;
  const auto index = static_cast<std::size_t>(sensor.samples++ % sensor.plan.samples);
  for (std::size_t axis = 0; axis < kMaxAxes; ++axis) {
    if (sensor.plan.axis[axis].samples.empty()) continue;
    double acceleration = noise_.rms * normal_(random_);
    for (std::size_t tool = 0; tool < kMaxAxes; ++tool)  // the rotation's transpose: tool to sensor frame
      acceleration += sensor.plan.rotation[tool][axis] * tool_acceleration[static_cast<Eigen::Index>(tool)];
    const SignalPlan& signal = sensor.plan.axis[axis].samples[index];
    const double value = faulty(faults_.axis[axis], acceleration / sensor.plan.unit_m_per_s2, sensor.last[axis], signal,
                                sensor.plan.unit_m_per_s2);
    sensor.last[axis] = value;
    if (value <= signal.low || value >= signal.high) ++saturated_;
    put(frames_[sensor.message], signal, value);
  }
}

std::span<const CanFrame> CanEncoder::advance(double time, const Eigen::Vector3d& velocity, double spindle_speed) {
  due_.clear();
  if (!started_) speed_ = spindle_speed;
  started_ = true;
  const auto part_at = [&](double at) { return time > time_ ? (at - time_) / (time - time_) : 1.0; };
  while (plan_.spindle && static_cast<double>(spindle_sent_) * spindle_period_ <= time) {
    const double at = static_cast<double>(spindle_sent_++) * spindle_period_;
    CanFrame& frame = frames_[spindle_frame_];
    select(frame, plan_.spindle->multiplex);
    put(frame, plan_.spindle->speed, rad_s_to_rpm(std::lerp(speed_, spindle_speed, part_at(at))));
    send(spindle_frame_, at);
  }
  for (Sensor& sensor : sensors_) {
    while (static_cast<double>(sensor.samples + 1) / sensor.sample_rate_hz <= time) {
      const double at = static_cast<double>(sensor.samples + 1) / sensor.sample_rate_hz;
      sample(sensor, velocity_ + part_at(at) * (velocity - velocity_));
      if (sensor.samples % sensor.plan.samples != 0 || faults_.silent) continue;
      CanFrame& frame = frames_[sensor.message];
      select(frame, sensor.plan.multiplex);
      if (sensor.plan.counter) write_bits(frame.data.data(), *sensor.plan.counter, sensor.counter++);
      // Sensors that share a frame fill it together; the last of them sends it.
      const bool last = std::none_of(&sensor + 1, sensors_.data() + sensors_.size(),
                                     [&](const Sensor& other) { return other.message == sensor.message; });
      if (last) send(sensor.message, at);
    }
  }
  std::stable_sort(due_.begin(), due_.end(),
                   [](const CanFrame& a, const CanFrame& b) { return a.stamp_ns < b.stamp_ns; });
  time_ = time;
  velocity_ = velocity;
  speed_ = spindle_speed;
  return due_;
}

}  // namespace stillcut
