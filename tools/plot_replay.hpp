// The one picture of a replayed cut: what the sensor felt, where its frequencies lie, when the monitor called it
// chatter, and which spindle speed it asked for instead; four panels on one time axis, a fifth where the decay of a
// mode could be measured before that.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "dsp/numbers.hpp"
#include "dsp/signals.hpp"
#include "tools/plot.hpp"

namespace stillcut {

struct TracePoint {
  double time_s = 0.0;
  double indicator = 0.0;  // 1 is the alarm limit; NaN: cannot tell
  double spindle_speed_rpm = 0.0;
  State state = State::idle;
  double chatter_frequency_hz = kNaN;  // NaN: no chatter just now
  double decay_per_s = kNaN;           // of the residual mode that dies out slowest; NaN: cannot be told
};

struct ReplayEvent {
  double time_s = 0.0;
  EventType type = EventType::fault;
  ChatterKind kind = ChatterKind::unknown;
  double frequency_hz = 0.0;
  double spindle_speed_rpm = 0.0;  // in a correction the target
};

struct ReplayTrace {
  std::string title, subtitle;
  double sample_rate_hz = 0.0;
  double start_s = 0.0;          // time of vibration[0]
  std::vector<float> vibration;  // m/s^2, one axis, equally spaced; NaN where samples were lost
  int teeth = 0;
  double min_speed_rpm = 0.0, max_speed_rpm = 0.0;  // the spindle's limits, drawn when near; 0: unknown
  std::vector<TracePoint> trace;                    // rising time
  std::vector<ReplayEvent> events;                  // rising time
};

// The picture as a value; write_figure draws it.
plot::Figure replay_figure(const ReplayTrace& replay);

// Draws it to an .svg or .png file. Throws InputError, see write_figure.
void plot_replay(const ReplayTrace& replay, const std::filesystem::path& file);

}  // namespace stillcut
