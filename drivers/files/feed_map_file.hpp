// The feed map: which way to feed where, as `stillcut patterns --feed-map` writes it and the daemon proposes from it.
#pragma once

#include <filesystem>
#include <vector>

namespace stillcut {

struct FeedProposal {
  double x = 0.0, y = 0.0;  // m, workpiece
  double direction = 0.0;   // rad, either sense
};

struct FeedMap {
  std::vector<FeedProposal> proposals;
  double reach = 0.0;  // m: how far one holds (models/places.hpp)
};

// Columns x_mm, y_mm and feed_direction_deg; spindle_speed_rpm and a_lim_mm may be there for people. Throws InputError
// with file, line and column, for no row, a place that stands twice, or a number out of range.
FeedMap read_feed_map(const std::filesystem::path& file);

// The direction proposed nearest to a place (m), rad; NaN beyond the reach of all, and without any.
double planned_direction(const FeedMap& map, double x, double y);

}  // namespace stillcut
