// A core, a cut in which it hears chatter, and all that it says, for tests.
#pragma once

#include <cmath>
#include <functional>
#include <ostream>
#include <sstream>
#include <vector>

#include "rt/core.hpp"
#include "tests/dsp/synthetic_cut.hpp"
#include "tests/rt/monitor_script.hpp"

namespace stillcut {

inline constexpr std::int64_t kStart = kSyntheticOrigin_ns;

inline SyntheticCut chattering_cut() {
  SyntheticCut cut;
  cut.rate_hz = 10000.0;
  cut.axes = 1;
  cut.duration_s = 3.0;
  cut.speed_rpm = [](double) { return 9000.0; };
  cut.depth = [](double t) { return t > 0.4 && t < 2.0 ? 1.0 : 0.0; };
  cut.chatter.frequency_hz = 717.0;
  cut.chatter.start_s = 1.2;
  cut.chatter.stop_s = 1.9;
  return cut;
}

inline CoreSettings settings_of(const SyntheticCut& cut, RuntimeMode mode = RuntimeMode::shadow) {
  CoreSettings settings;
  settings.monitor = monitor_settings(cut);
  settings.compensator = {mode, cut.teeth, {.spindle = spindle_6000_to_12000(), .spindle_time_constant_s = 0.05}};
  settings.axial_depth = 1e-3;
  settings.nominal_speed = rpm_to_rad_s(9000);
  return settings;
}

inline void write(std::ostream& out, const Output& output) {
  out << std::hexfloat;
  if (output.type == Output::Type::event) {
    const Event& e = output.event;
    out << "event " << e.stamp_ns << ' ' << int(e.type) << ' ' << int(e.kind) << ' ' << e.frequency_hz << ' '
        << e.indicator << ' ' << e.spindle_speed_rpm << ' ' << e.note.data() << '\n';
  } else if (output.type == Output::Type::correction) {
    const Correction& c = output.correction;
    out << "correction " << c.stamp_ns << ' ' << c.sequence << ' ' << c.valid_for_ms << ' ' << int(c.mode) << ' '
        << int(c.kind) << ' ' << c.spindle_speed_rpm << ' ' << c.spindle_speed_target_rpm << ' ' << c.feed_override
        << ' ' << c.feed_direction << ' ' << c.chatter_frequency_hz << ' ' << c.predicted_margin_before << ' '
        << c.predicted_margin_after << ' ' << c.limited_by << ' ' << int(c.confidence_percent) << ' ' << c.reason.data()
        << '\n';
  } else {
    const Status& s = output.status;
    out << "status " << s.stamp_ns << ' ' << int(s.state) << ' ' << int(s.mode) << ' ' << s.spindle_speed_rpm << ' '
        << s.indicator << ' ' << s.margin << ' ' << s.chatter_frequency_hz << ' ' << s.frames << ' ' << s.frames_lost
        << ' ' << s.lobes_stamp_ns << '\n';
  }
}

// A core that keeps what it says.
struct Heard {
  explicit Heard(const CoreSettings& settings) : core{settings} {}

  void listen() {
    for (const Output& output : core.outputs()) {
      if (output.type == Output::Type::event) events.push_back(output.event);
      if (output.type == Output::Type::status) statuses.push_back(output.status);
      if (output.type == Output::Type::correction) corrections.push_back(output.correction);
      write(all, output);
    }
    core.clear_outputs();
  }
  bool frame(std::int64_t stamp_ns) {
    const bool accepted = core.accept_frame(stamp_ns);
    listen();
    return accepted;
  }
  void play(const SyntheticLog& log, const std::function<void(std::int64_t)>& before_each = {}) {
    std::size_t next_speed = 0;
    for (const SampleBlock& block : log.blocks) {
      for (; next_speed < log.speeds.size() && log.speeds[next_speed].stamp_ns <= block.stamp_ns; ++next_speed) {
        if (core.accept_frame(log.speeds[next_speed].stamp_ns)) core.add_speed(log.speeds[next_speed]);
      }
      if (before_each) before_each(block.stamp_ns);
      if (core.accept_frame(block.stamp_ns)) core.add_samples(block);
      listen();
    }
  }

  Core core;
  std::vector<Event> events;
  std::vector<Status> statuses;
  std::vector<Correction> corrections;
  std::ostringstream all;
};

inline LobeDiagram dated(std::int64_t usable_from_ns, std::int64_t posture_ns, double limit_mm = 0.5) {
  LobeDiagram diagram = diagram_of({limit_mm, limit_mm, limit_mm}, spindle_6000_to_12000());
  diagram.usable_from_ns = usable_from_ns;
  diagram.posture_stamp_ns = posture_ns;
  return diagram;
}

inline RobotState state_at(std::int64_t stamp_ns) {
  RobotState state;
  state.stamp_ns = stamp_ns;
  state.axial_depth = std::nan("");
  return state;
}

}  // namespace stillcut
