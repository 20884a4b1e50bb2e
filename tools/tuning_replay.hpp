// Plays logs through the pipeline of daemon and `stillcut replay` once for each alarm limit, over all cores, and keeps
// what the monitor heard.
#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "drivers/files/cell.hpp"
#include "models/lobe_diagram.hpp"
#include "tools/tuning_score.hpp"

namespace stillcut {

struct HeardLog {
  double duration_s = 0.0;
  std::string warning;               // of lines passed over, for the user; empty: none
  std::vector<LogHearing> at_limit;  // one a limit
};

// Plays every log at every limit, `jobs` at a time; what comes out does not depend on how many. `lobes` is the
// prediction for the cell's own posture and cut. `progress` is told the share that is done, by the calling thread.
// Throws InputError: the first log, in their order, that cannot be read or holds no samples of the cell's sensors.
std::vector<HeardLog> hear_logs(const Cell& cell, const LobeDiagram& lobes, std::span<const std::filesystem::path> logs,
                                std::span<const double> limits, int jobs, const std::function<void(double)>& progress);

// Which onsets begin something new. A kind told later belongs to the episode that first said unknown; chatter of the
// structure may begin beside the tool's.
class OnsetCollector {
 public:
  void add(const Event& event, double time_s);
  [[nodiscard]] const std::vector<HeardOnset>& onsets() const { return onsets_; }

 private:
  std::vector<HeardOnset> onsets_;
  bool unnamed_ = false;  // an episode of the tool's is open, its kind yet unknown
};

}  // namespace stillcut
