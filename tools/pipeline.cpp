#include "tools/pipeline.hpp"

#include <algorithm>

namespace stillcut {
namespace {

constexpr double kLowestSampleRate_hz = 500.0;  // of the monitor

}  // namespace

CompensationLimits compensation_limits(const Cell& cell) {
  const CompensationSettings& asked = cell.compensation;
  CompensationLimits limits = asked.limits;
  limits.spindle = require(cell, cell.spindle, "spindle");
  limits.feed_per_tooth = require(cell, cell.cut, "cut").feed_per_tooth;
  const double radius = 0.5 * require(cell, cell.tool, "tool").diameter;
  limits.spindle.min_speed = std::max(limits.spindle.min_speed, asked.min_cutting_speed / radius);
  limits.spindle.max_speed = std::min(limits.spindle.max_speed, asked.max_cutting_speed / radius);
  if (!(limits.spindle.max_speed > limits.spindle.min_speed))
    throw InputError(cell.file.string(), 0,
                     "compensation: the window of cutting speed leaves no speed of the spindle's range; check "
                     "min_cutting_speed_m_per_min, max_cutting_speed_m_per_min and the tool's diameter");
  return limits;
}

CoreSettings core_settings(const Cell& cell) {
  const Tool& tool = require(cell, cell.tool, "tool");
  const Cut& cut = require(cell, cell.cut, "cut");
  const SpindleLimits& spindle = require(cell, cell.spindle, "spindle");
  const CanSettings& can = require(cell, cell.can, "can");

  CoreSettings settings;
  if (can.accelerometers.empty()) {
    throw InputError(cell.file.string(), can.line, "can.accelerometer: is missing; add a [[can.accelerometer]] table");
  }
  for (const AccelerometerSettings& accelerometer : can.accelerometers) {
    std::uint8_t axes = 0;
    for (int a = 0; a < kMaxAxes; ++a) axes |= accelerometer.axis[a].empty() ? 0 : 1U << a;
    if (accelerometer.sample_rate_hz < kLowestSampleRate_hz) {
      throw InputError(cell.file.string(), accelerometer.line,
                       "can.accelerometer.sample_rate_hz: is too low to hear chatter; needs 500 or more");
    }
    settings.monitor.sensors.push_back({accelerometer.sample_rate_hz, axes});
  }
  settings.monitor.highest_speed = spindle.max_speed;
  settings.monitor.nominal_speed = cut.spindle_speed;
  settings.monitor.has_speed_signal = !can.spindle_speed.empty();
  settings.monitor.teeth = tool.teeth;
  settings.monitor.watch.limit = cell.detection.limit.value_or(settings.monitor.watch.limit);
  settings.monitor.release_ratio = cell.detection.release_ratio.value_or(settings.monitor.release_ratio);
  settings.compensator.mode = cell.mode;
  settings.compensator.teeth = tool.teeth;
  settings.compensator.limits = compensation_limits(cell);
  settings.axial_depth = cut.axial_depth;
  settings.feed_direction = cut.feed_direction;
  settings.nominal_speed = cut.spindle_speed;
  return settings;
}

Pipeline::Pipeline(const Cell& cell)
    : decoder_{read_dbc(require(cell, cell.can, "can").dbc), *cell.can, cell.file.string()},
      core_{core_settings(cell)} {}

bool Pipeline::feed(const CanFrame& frame) noexcept {
  probe_(Stage::decide);  // what fell due before this frame
  if (!core_.accept_frame(frame.stamp_ns)) return false;
  probe_(Stage::decode);
  if (frame.is_error()) {
    core_.add_bus_error(frame.id, frame.data[1]);
    return false;
  }
  if (!decoder_.decode(frame, decoded_)) return false;
  probe_(Stage::decide);
  if (decoded_.has_speed) core_.add_speed(decoded_.spindle);
  for (int b = 0; b < decoded_.blocks; ++b) core_.add_samples(decoded_.block[b]);
  return decoded_.has_speed || decoded_.blocks > 0;
}

}  // namespace stillcut
