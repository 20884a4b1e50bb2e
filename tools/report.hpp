// What `stillcut report` tells of a shift or a cut: gathered in one pass over the recording (report_collector.hpp),
// then written as a page for people (report_page.hpp) or as JSON. Times are seconds since the first frame.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "drivers/lcm/telemetry_messages.hpp"
#include "dsp/numbers.hpp"
#include "models/lobe_diagram.hpp"
#include "rt/signals.hpp"
#include "tools/plot_replay.hpp"

namespace stillcut {

inline constexpr int kStates = 8;  // of State

// A stretch of the timeline; what was worst in it.
struct TimelinePoint {
  double begin_s = 0.0;
  State state = State::idle;  // the gravest
  double indicator = kNaN;    // the largest; NaN: cannot tell
  double low_rpm = kNaN, high_rpm = kNaN;
  double level = kNaN;  // m/s², the largest rms of 50 ms over all axes of the first accelerometer
};

struct ReportCorrection {
  double time_s = 0.0;
  std::string note;                               // of the event
  CorrectionKind kind = CorrectionKind::release;  // release: no setting was known
  RuntimeMode mode = RuntimeMode::shadow;
  double from_rpm = kNaN, target_rpm = kNaN;
  double margin_before = kNaN, margin_after = kNaN;  // predicted, a_lim/a - 1
  std::int8_t confidence_percent = 0;
  std::int64_t first_sequence = 0, last_sequence = 0;  // of the messages that asked for it; 0: none
  std::int64_t accepted = 0, refused = 0;              // acknowledgements of these
  std::string refusal;                                 // the controller's words
};

struct ReportEpisode {                 // of chatter
  double onset_s = 0.0, end_s = kNaN;  // end NaN: not within the recording
  std::string onset_note, end_note;
  ChatterKind kind = ChatterKind::unknown;
  double frequency_hz = kNaN;
  double indicator = kNaN;                   // the largest
  double speed_rpm = kNaN, depth_mm = kNaN;  // at the onset
  double margin = kNaN;                      // predicted there
  double end_speed_rpm = kNaN, end_depth_mm = kNaN;
  double level_before = kNaN;  // m/s² rms, the loudest 50 ms of it
  double level_after = kNaN;   // mean of half a second from 0.1 s after its end; NaN: the tool was not in the cut
  double again_s = kNaN;       // onset of the next one in the same cut, where it came at once
  int asked_before = -1;       // index of the episode whose correction was still asked for at its onset
  int cut = -1;                // index of the cut it belongs to
  int diagram = -1;            // of the lobes
  std::vector<ReportCorrection> corrections;
  std::optional<ReplayTrace> picture;  // around the onset; of the worst episodes only
};

struct ReportCut {
  double begin_s = 0.0, end_s = kNaN;
  double speed_rpm = kNaN;  // mean
  double depth_mm = kNaN;   // the deepest
  double indicator = kNaN;  // the largest
  double level = kNaN;      // the largest, m/s² rms
  double margin = kNaN;     // the least predicted
  double chatter_s = 0.0;
  int episodes = 0;
  int diagram = -1;
};

struct ReportLobes {
  LobeDiagram diagram;
  double time_s = 0.0;  // a moment at which they were in use
};

struct ReportSensor {
  double sample_rate_hz = 0.0;  // as the cell says
  double measured_hz = kNaN;    // by the frames' stamps
  double measured_within_hz = kNaN;
  std::int64_t samples = 0, missing = 0, gaps = 0, saturated = 0, not_finite = 0;
  double longest_gap_s = 0.0;
};

struct ReportFault {
  std::string what;
  std::int64_t count = 0;
  double first_s = 0.0, last_s = 0.0;
};

struct Report {
  std::string cell, recording, tool, material, posture;
  RuntimeMode mode = RuntimeMode::shadow;
  bool depth_from_robot = false;
  std::int64_t origin_ns = 0;
  double played_s = 0.0;
  std::int64_t frames = 0, frames_bad = 0, frames_lost = 0, frames_out_of_order = 0, inputs_lost = 0;
  bool from_the_start = true;
  std::vector<std::string> warnings;
  std::array<double, kStates> state_s{};  // time in each state
  double indicator = kNaN;                // the largest outside chatter
  double min_rpm = 0.0, max_rpm = 0.0;    // of the spindle
  std::vector<TimelinePoint> timeline;
  double timeline_step_s = 0.0;
  std::vector<ReportCut> cuts;
  std::vector<ReportEpisode> episodes;
  std::int64_t forced_vibrations = 0;  // told of, no chatter
  std::vector<ReportLobes> lobes;
  std::vector<ReportSensor> sensors;
  std::vector<ReportFault> faults;
  std::optional<LatencyReport> loop_times;
};

}  // namespace stillcut
