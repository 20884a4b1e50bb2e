// A monitor's view made by hand, for tests of what listens to it.
#pragma once

#include <cmath>
#include <vector>

#include "dsp/monitor.hpp"
#include "models/lobe_diagram.hpp"
#include "models/machining.hpp"
#include "rt/compensator.hpp"

namespace stillcut {

inline constexpr std::int64_t kSecond = 1'000'000'000, kMillisecond = 1'000'000;

// A two-tooth tool that chatters at 738 Hz and 9000 rpm: n_k are 22140, 11070, 7380 and 5535 rpm.
inline MonitorView chattering(std::int64_t stamp_ns, double frequency_hz = 738.0, double speed_rpm = 9000.0) {
  MonitorView view;
  view.stamp_ns = stamp_ns;
  view.state = State::chatter;
  view.indicator = 3.0;
  view.speed = rpm_to_rad_s(speed_rpm);
  view.chatter = true;
  view.kind = ChatterKind::regenerative;
  view.chatter_frequency_hz = frequency_hz;
  view.chatter_amplitude = 10.0;
  return view;
}

inline MonitorView quiet(std::int64_t stamp_ns, State state = State::cut, double speed_rpm = 9000.0) {
  MonitorView view;
  view.stamp_ns = stamp_ns;
  view.state = state;
  view.indicator = 0.2;
  view.speed = rpm_to_rad_s(speed_rpm);
  view.chatter_frequency_hz = std::nan("");
  return view;
}

inline SpindleLimits spindle_6000_to_12000() {
  return {rpm_to_rad_s(6000), rpm_to_rad_s(12000), rpm_to_rad_s(3000), rpm_to_rad_s(30000)};
}

// Depth limits in mm at equally spaced speeds over the spindle's range.
inline LobeDiagram diagram_of(const std::vector<double>& limits_mm, const SpindleLimits& spindle) {
  LobeDiagram diagram;
  diagram.valid = true;
  diagram.point_count = static_cast<int>(limits_mm.size());
  const double spacing = (spindle.max_speed - spindle.min_speed) / (diagram.point_count - 1);
  for (std::size_t i = 0; i < limits_mm.size(); ++i) {
    diagram.points[i] = {spindle.min_speed + spacing * static_cast<double>(i), limits_mm[i] * 1e-3, 738.0};
  }
  return diagram;
}

}  // namespace stillcut
