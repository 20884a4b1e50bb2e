// A recording played through the daemon's own code, once, from its beginning: what all commands that take a recording
// listen to. Memory is bounded whatever its length.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "drivers/files/cell.hpp"
#include "drivers/lcm/lcm_log.hpp"
#include "drivers/lcm/telemetry_messages.hpp"
#include "tools/pipeline.hpp"

namespace stillcut {

struct PlaybackSource {
  std::string can, lcm;       // as `stillcut replay` takes them; lcm may be empty
  double lcm_offset_s = 0.0;  // to add to the LCM log's times
};

// Whom to tell; what is empty is not told.
struct PlaybackListener {
  std::function<void(const Pipeline&)> on_frame;              // a frame brought samples or speed: see decoded()
  std::function<void(const Output&, const Core&)> on_output;  // what was decided, in order
  std::function<void(const RobotMessage&)> on_robot;          // state or acknowledgement, as it goes into the core
};

struct PlaybackSummary {
  std::int64_t origin_ns = 0;  // stamp of the first frame
  double played_s = 0.0;       // from there to the last frame that was played
  double wall_s = 0.0;         // that playing took
  std::int64_t frames = 0, frames_bad = 0, frames_lost = 0, frames_out_of_order = 0;
  bool is_recording = false, from_the_start = true;
  std::int64_t inputs_lost = 0;  // that the recorder had to leave out
  // Outputs: of the live run, of this one, and how many from the first on are the same, bit for bit.
  std::size_t outputs_recorded = 0, outputs_decided = 0, outputs_same = 0;
  std::optional<LatencyReport> loop_times;  // the newest that the recording holds
  std::vector<std::string> warnings;        // lines for the user
};

// `decide`: with the cell's dynamics map, so that predictions and corrections are those of the live run; without it
// nothing of the map is read and outputs are not told. What comes after `until_s` (infinite: to the end) is not
// played. Throws InputError.
PlaybackSummary play(const Cell& cell, const PlaybackSource& source, bool decide, double until_s,
                     const PlaybackListener& listener);

}  // namespace stillcut
