// The same cut three times: as it chatters, corrected, and at a depth that needs no correction. What a correction is
// worth in surface and in metal removed.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "drivers/files/cell.hpp"
#include "drivers/files/scenario.hpp"
#include "tools/closed_loop.hpp"
#include "tools/hil_score.hpp"
#include "tools/plot.hpp"

namespace stillcut {

struct ComparedRun {
  std::string name;
  std::unique_ptr<VirtualMachine> machine;
  Heard heard;
  HilScore score;
  std::vector<double> surface_time;  // s: when the score's sampling lengths were cut, the first ones of them
  double ra_at_end = kNaN;           // m, mean over the last second at the full depth
};

// The largest depth that the lobes call sound, one tenth below the limit, at every speed, feed direction and posture
// that the program commands; m, infinite where no depth is unsound. Throws InputError where the lobes cannot be
// computed.
double sound_depth(const Cell& cell, const Scenario& scenario);

// In data time: "not corrected", "corrected", and "at a sound depth", which is left out where the program stays below
// it anyway or no depth is sound. `progress` is told the share that is done.
std::vector<ComparedRun> compare_runs(const Cell& cell, const Scenario& scenario, std::int64_t origin_ns,
                                      const std::function<void(double)>& progress);

void print_comparison(const std::vector<ComparedRun>& runs);
plot::Figure comparison_figure(const std::string& title, const Cell& cell, const std::vector<ComparedRun>& runs);

}  // namespace stillcut
