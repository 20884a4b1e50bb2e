// Where the tool chattered, at which frequency, and how it was cutting then: what `stillcut refine` holds against the
// lobes. From logs played through the pipeline of the daemon, or from the events that a run wrote.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "drivers/files/cell.hpp"
#include "dsp/monitor.hpp"
#include "models/dynamics_map.hpp"
#include "models/map_refinement.hpp"
#include "rt/signals.hpp"
#include "tools/playback.hpp"

namespace stillcut {

struct ChatteredCut {
  double time_s = 0.0;  // since the first frame
  HeardChatter heard;
  Cut cut;          // the cell's, with what the robot reported
  Posture posture;  // likewise
};

// One regenerative chatter of a single line, at most, for each episode: the median frequency of its first 0.3 s, while
// the speed stands; none where that wanders. Chatter on a spindle order (kind unknown) and of the structure is left
// out.
class ChatterCollector {
 public:
  // `posture`: where the cell works when no robot says otherwise.
  ChatterCollector(const Cell& cell, Posture posture);

  // After every frame; `robot` may be nullptr.
  void look(const MonitorView& view, const RobotState* robot, std::int64_t origin_ns);
  // After the last one.
  [[nodiscard]] std::vector<ChatteredCut> finish();

 private:
  void close();

  Cut nominal_;
  Posture posture_;
  std::vector<ChatteredCut> cuts_;
  ChatteredCut open_;
  std::vector<double> frequencies_;
  std::int64_t last_ns_ = 0, begin_ns_ = 0;
  bool in_episode_ = false, listening_ = false;
};

// `warnings`: lines for the user. Throws InputError.
std::vector<ChatteredCut> chattered_in_log(const Cell& cell, const PlaybackSource& source,
                                           std::vector<std::string>& warnings);

// Of an events file (contracts.md): onsets of kind regenerative, at the cell's own posture and depth.
std::vector<ChatteredCut> chattered_in_events(const Cell& cell, const std::filesystem::path& file);

}  // namespace stillcut
