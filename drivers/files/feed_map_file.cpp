#include "drivers/files/feed_map_file.hpp"

#include <cmath>

#include "drivers/files/csv.hpp"
#include "drivers/files/input_error.hpp"
#include "dsp/numbers.hpp"
#include "models/machining.hpp"
#include "models/places.hpp"

namespace stillcut {
namespace {

double distance_between(const FeedProposal& a, const FeedProposal& b) { return std::hypot(a.x - b.x, a.y - b.y); }

double bounded(const CsvTable& table, const CsvRow& row, std::size_t column, double most) {
  const double value = table.number(row, column);
  if (!(std::abs(value) <= most))
    table.fail(row, column, csv_number(value) + " is out of range; give a number up to " + csv_number(most));
  return value;
}

}  // namespace

FeedMap read_feed_map(const std::filesystem::path& file) {
  constexpr double kMostMm = 1e5, kMostDegrees = 360.0;
  const CsvTable table = read_csv(file);
  const std::vector<std::string> known{"x_mm", "y_mm", "feed_direction_deg", "spindle_speed_rpm", "a_lim_mm"};
  check_column_names(table, known);
  const std::size_t x = table.require_column("x_mm"), y = table.require_column("y_mm");
  const std::size_t direction = table.require_column("feed_direction_deg");
  FeedMap map;
  for (const CsvRow& row : table.rows()) {
    const FeedProposal proposal{1e-3 * bounded(table, row, x, kMostMm), 1e-3 * bounded(table, row, y, kMostMm),
                                deg_to_rad(bounded(table, row, direction, kMostDegrees))};
    for (const FeedProposal& other : map.proposals)
      if (distance_between(other, proposal) == 0.0) table.fail(row, x, "this place stands twice; leave one out");
    map.proposals.push_back(proposal);
  }
  if (map.proposals.empty())
    throw InputError(file.string(), 0, "has no row; write one with stillcut patterns CELL --feed-map");
  std::vector<Eigen::Vector2d> places;
  places.reserve(map.proposals.size());
  for (const FeedProposal& proposal : map.proposals) places.emplace_back(proposal.x, proposal.y);
  map.reach = reach_of(places);
  return map;
}

double planned_direction(const FeedMap& map, double x, double y) {
  double direction = kNaN, nearest = kInfinity;
  for (const FeedProposal& proposal : map.proposals) {
    const double distance = distance_between(proposal, {x, y, 0.0});
    if (distance <= map.reach && distance < nearest) nearest = distance, direction = proposal.direction;
  }
  return direction;
}

}  // namespace stillcut
