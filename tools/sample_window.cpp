#include "tools/sample_window.hpp"

#include <algorithm>
#include <cmath>

namespace stillcut {
namespace {

constexpr double kSameMoment = 1e-4;  // of a step

// How many of `count` evenly spaced moments, the first at `begin`, lie before `limit`. Where it is a sample's own
// time as CSV has it, rounding must not decide.
std::int64_t moments_before(double limit, double begin, double step, std::int64_t count) {
  const double place = std::ceil((limit - begin) / step - kSameMoment);  // of the first that does not
  if (!(place > 0.0)) return 0;
  return place < static_cast<double>(count) ? static_cast<std::int64_t>(place) : count;
}

}  // namespace

SampleWindow::SampleWindow(std::span<const AccelerometerSettings> sensors, double from_s, double to_s)
    : from_s_{from_s}, to_s_{to_s} {
  for (const AccelerometerSettings& sensor : sensors)
    sensors_.push_back({SampleClock{sensor.sample_rate_hz}, 1.0 / sensor.sample_rate_hz});
}

std::optional<SampleStretch> SampleWindow::cut(const SampleBlock& block, std::int64_t origin_ns) {
  Sensor& sensor = sensors_.at(block.sensor);
  const SampleClock::Placed placed = sensor.clock.place(block.stamp_ns, block.samples, block.frames_lost);
  const double first_s = static_cast<double>(placed.stamp_ns - origin_ns) * 1e-9 - (block.samples - 1) * sensor.step_s;
  const double begin_s = first_s - static_cast<double>(placed.samples_lost) * sensor.step_s;
  const std::int64_t all = placed.samples_lost + block.samples;
  const std::int64_t from = moments_before(from_s_, begin_s, sensor.step_s, all),
                     to = moments_before(to_s_, begin_s, sensor.step_s, all);
  if (from >= to) return std::nullopt;

  SampleStretch stretch;
  stretch.sensor = block.sensor;
  stretch.step_s = sensor.step_s;
  stretch.begin_s = begin_s + static_cast<double>(from) * sensor.step_s;
  stretch.missing = std::max<std::int64_t>(0, std::min(to, placed.samples_lost) - from);
  const std::int64_t first = std::max<std::int64_t>(0, from - placed.samples_lost),
                     last = std::max<std::int64_t>(0, to - placed.samples_lost);
  stretch.samples = static_cast<int>(last - first);
  for (std::size_t a = 0; a < kMaxAxes; ++a) {
    if ((block.axes_present >> a & 1U) != 0)
      stretch.axis[a] = std::span{block.acceleration[a]}.subspan(static_cast<std::size_t>(first),
                                                                 static_cast<std::size_t>(stretch.samples));
  }
  return stretch;
}

}  // namespace stillcut
