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
#include "tools/posture_variations.hpp"

namespace stillcut {

struct PostureDirections {
  PredictedPosture predicted;
  std::vector<DirectionCurve> curves;  // one a direction
  std::size_t task = 0;                // which of the asked postures it is a variation of
  Variation variation;
  double own_limit = 0.0;  // m, absolute, in the cell's own feed direction; only where variations were asked
};

struct DirectionsResult {
  DirectionStudy study;
  std::vector<PostureDirections> postures;  // every asked one, with every variation that the robot can stand in
  std::vector<std::string> warnings;        // lines that the user must read
  VariationsAsked asked;
  std::vector<std::string> tasks{};  // ids of the asked postures
};

// Computes all postures, each with all variations, on `threads` threads; the result does not depend on how many. `cut`
// is the cell's, with what the user set differently. No posture named: every posture of the map. Variations in which
// the robot cannot stand are left out, and a warning says how many. Throws InputError, also where none is left.
// `progress` is told the share done, from the calling thread.
DirectionsResult study_directions(const Cell& cell, const Cut& cut, const std::vector<std::string>& postures,
                                  const VariationsAsked& asked, const DirectionStudy& study, int threads,
                                  const std::function<void(double)>& progress);

// The direction with the highest absolute limit; of equal ones the first.
std::size_t best_direction(const PostureDirections& posture);

// posture,feed_direction_deg,a_abs_mm,a_pocket_mm,pocket_rpm; with variations also
// redundancy_deg,placement_x_mm,placement_y_mm,outside_map.
void write_directions_csv(const DirectionsResult& result, std::ostream& out);

nlohmann::ordered_json directions_json(const DirectionsResult& result);

// A line a posture: its best direction, its worst, the deepest pocket.
void print_directions_summary(const DirectionsResult& result, std::ostream& out);

// The absolute limit as distance from the middle, in every direction; a line a posture.
plot::Figure directions_figure(const DirectionsResult& result);

}  // namespace stillcut
