// What `stillcut directions` answers: limits over the feed direction at each posture, and how they are written for
// programs and people.
#pragma once

#include <functional>
#include <iosfwd>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "models/direction_limits.hpp"
#include "tools/cell_posture.hpp"
#include "tools/plot.hpp"

namespace stillcut {

struct PostureDirections {
  PredictedPosture predicted;
  std::vector<DirectionCurve> curves;  // one a direction
};

struct DirectionsResult {
  DirectionStudy study;
  std::vector<PostureDirections> postures;
  std::vector<std::string> warnings;  // lines that the user must read
};

// Computes all postures, on `threads` threads; the result does not depend on how many. `cut` is the cell's, with what
// the user set differently. No posture named: every posture of the map. Throws InputError. `progress` is told the share
// done, from the calling thread.
DirectionsResult study_directions(const Cell& cell, const Cut& cut, const std::vector<std::string>& postures,
                                  const DirectionStudy& study, int threads,
                                  const std::function<void(double)>& progress);

// The direction with the highest absolute limit; of equal ones the first.
std::size_t best_direction(const PostureDirections& posture);

// posture,feed_direction_deg,a_abs_mm,a_pocket_mm,pocket_rpm.
void write_directions_csv(const DirectionsResult& result, std::ostream& out);

nlohmann::ordered_json directions_json(const DirectionsResult& result);

// A line a posture: its best direction, its worst, the deepest pocket.
void print_directions_summary(const DirectionsResult& result, std::ostream& out);

// The absolute limit as distance from the middle, in every direction; a line a posture.
plot::Figure directions_figure(const DirectionsResult& result);

}  // namespace stillcut
