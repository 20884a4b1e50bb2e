#include "models/path_plan.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "dsp/numbers.hpp"
#include "models/location_grid.hpp"

namespace stillcut {
namespace {

constexpr int kMostLines = 10;
constexpr int kLevels = 24;           // of depth that are tried for the least time
constexpr double kLowestLevel = 0.7;  // of the best single direction's depth: a faster spindle may be worth that
constexpr double kRightAngle = 0.5 * std::numbers::pi;

// The used locations on their grid, and what is asked of their curves.
class Area {
 public:
  Area(const DirectionTable& table, std::span<const std::size_t> used)
      : table_(table), used_(used.begin(), used.end()), grid_(location_grid(places(), kMostLines)) {
    cells_.resize(static_cast<std::size_t>(grid_.columns() * grid_.rows()));
    for (std::size_t i = 0; i < used_.size(); ++i) cells_[cell(grid_.column[i], grid_.row[i])].push_back(i);
    for (const std::size_t location : used_) {
      std::vector<const DirectionCurve*> curves;
      curves.reserve(table.directions.size());
      for (const double direction : table.directions)
        curves.push_back(&curve_at(table.locations[location].curves, direction));
      curves_.push_back(curves);
    }
  }

  [[nodiscard]] const DirectionTable& table() const { return table_; }
  [[nodiscard]] const LocationGrid& grid() const { return grid_; }
  [[nodiscard]] std::size_t count() const { return used_.size(); }
  [[nodiscard]] std::size_t location(std::size_t i) const { return used_[i]; }
  [[nodiscard]] const DirectionCurve& curve(std::size_t i, int direction) const {
    return *curves_[i][static_cast<std::size_t>(direction)];
  }
  [[nodiscard]] GridRectangle whole() const { return {0, grid_.columns(), 0, grid_.rows()}; }

  // Those of `used` that a rectangle holds.
  [[nodiscard]] std::vector<std::size_t> in(const GridRectangle& r) const {
    std::vector<std::size_t> found;
    for (int column = r.column_begin; column < r.column_end; ++column)
      for (int row = r.row_begin; row < r.row_end; ++row)
        found.insert(found.end(), cells_[cell(column, row)].begin(), cells_[cell(column, row)].end());
    return found;
  }

  // What holds at all of them along a direction.
  [[nodiscard]] std::vector<double> common(const std::vector<std::size_t>& members, int direction) const {
    std::vector<const DirectionCurve*> curves(members.size());
    std::transform(members.begin(), members.end(), curves.begin(), [&](std::size_t i) { return &curve(i, direction); });
    return common_limits(curves, table_.max_depth);
  }

 private:
  [[nodiscard]] std::vector<Eigen::Vector2d> places() const {
    std::vector<Eigen::Vector2d> places;
    places.reserve(used_.size());
    for (const std::size_t location : used_) places.push_back(table_.locations[location].place);
    return places;
  }
  [[nodiscard]] std::size_t cell(int column, int row) const {
    return static_cast<std::size_t>(column * grid_.rows() + row);
  }

  const DirectionTable& table_;
  std::vector<std::size_t> used_;
  LocationGrid grid_;
  std::vector<std::vector<std::size_t>> cells_;
  std::vector<std::vector<const DirectionCurve*>> curves_;  // of a used location, of a direction
};

double change_cost(const DirectionTable& table, int from, int to, double turning_cost) {
  const double angle =
      axis_angle(table.directions[static_cast<std::size_t>(from)], table.directions[static_cast<std::size_t>(to)]);
  return 0.5 * turning_cost * (1.0 + angle / kRightAngle);
}

PatchCosts costs_over(const Area& area, double turning_cost) {
  PatchCosts costs;
  costs.columns = area.grid().columns();
  costs.rows = area.grid().rows();
  costs.directions = static_cast<int>(area.table().directions.size());
  costs.change = [&area, turning_cost](int from, int to) { return change_cost(area.table(), from, to, turning_cost); };
  return costs;
}

// The share of the absolute stability index that a direction gives away at each location: [location][direction].
std::vector<std::vector<double>> lost_shares(const Area& area) {
  const DirectionTable& table = area.table();
  std::vector<std::vector<double>> lost(area.count(), std::vector<double>(table.directions.size(), 0.0));
  for (std::size_t i = 0; i < area.count(); ++i) {
    for (std::size_t d = 0; d < table.directions.size(); ++d) {
      const double ratio =
          stability_ratio(table, table.locations[area.location(i)], area.curve(i, static_cast<int>(d)));
      if (!std::isnan(ratio)) lost[i][d] = (1.0 - ratio) / static_cast<double>(area.count());
    }
  }
  return lost;
}

double lost_in(const std::vector<std::vector<double>>& lost, const std::vector<std::size_t>& members, int direction) {
  double sum = 0.0;
  for (const std::size_t i : members) sum += lost[i][static_cast<std::size_t>(direction)];
  return sum;
}

PatchPlan plan_for_absolute(const Area& area, double turning_cost, double& single_cost) {
  const std::vector<std::vector<double>> lost = lost_shares(area);
  const std::vector<std::size_t> all = area.in(area.whole());
  PatchCosts costs = costs_over(area, turning_cost);
  costs.patch = [&](const GridRectangle& rectangle, int direction) {
    return lost_in(lost, area.in(rectangle), direction);
  };
  single_cost = kInfinity;
  for (int d = 0; d < costs.directions; ++d) single_cost = std::min(single_cost, lost_in(lost, all, d));
  return plan_patches(costs);
}

// The highest speed at which all of them are stable at a depth, rad/s; 0: none.
double highest_speed(const Area& area, const std::vector<std::size_t>& members, int direction, double depth) {
  const std::vector<double>& speeds = area.table().speeds;
  for (std::size_t s = speeds.size(); s-- > 0;) {
    if (std::all_of(members.begin(), members.end(),
                    [&](std::size_t i) { return area.curve(i, direction).limits[s] >= depth; }))
      return speeds[s];
  }
  return 0.0;
}

// Time to cut a share of the area (all locations stand for equal parts) once over and by a unit of depth, but for the
// factor that feed per tooth and radial depth give.
double cutting_time(std::size_t members, std::size_t all, double speed, double depth) {
  if (members == 0) return 0.0;
  return speed > 0.0 ? static_cast<double>(members) / static_cast<double>(all) / (speed * depth) : kInfinity;
}

struct SingleDirection {
  double depth = 0.0, time = kInfinity;
};

// What one direction and speed for all take at least, and the depth of it; infinite where no depth is stable.
SingleDirection fastest_single(const Area& area) {
  std::vector<std::size_t> all = area.in(area.whole());
  SingleDirection best;
  for (std::size_t d = 0; d < area.table().directions.size(); ++d) {
    const std::vector<double> common = area.common(all, static_cast<int>(d));
    for (std::size_t s = 0; s < common.size(); ++s) {
      const double speed = area.table().speeds[s];
      if (!(common[s] > 0.0)) continue;
      const double time = cutting_time(1, 1, speed, common[s]);
      if (time < best.time) best = {common[s], time};
    }
  }
  return best;
}

// The deepest cut that is stable everywhere if every location has its own direction and speed, m.
double deepest_anywhere(const Area& area) {
  double least = area.table().max_depth;
  for (std::size_t i = 0; i < area.count(); ++i) {
    double deepest = 0.0;
    for (std::size_t d = 0; d < area.table().directions.size(); ++d)
      deepest = std::max(deepest, bounded_pocket_depth(area.curve(i, static_cast<int>(d)), area.table().max_depth));
    least = std::min(least, deepest);
  }
  return least;
}

std::vector<double> depth_levels(double single, double deepest) {
  const double first = single > 0.0 ? kLowestLevel * single : 0.1 * deepest;
  std::vector<double> levels;
  levels.reserve(kLevels + 1);
  for (int i = 0; i < kLevels; ++i) levels.push_back(first * std::pow(deepest / first, i / (kLevels - 1.0)));
  levels.back() = deepest;
  if (single > 0.0) levels.push_back(single);
  return levels;
}

struct TimedPlan {
  PatchPlan plan;  // its cost as a share of the reference's time
  double depth = 0.0;
};

TimedPlan plan_for_time(const Area& area, double turning_cost, const SingleDirection& single) {
  const double deepest = deepest_anywhere(area);
  if (!(deepest > 0.0))
    throw std::invalid_argument("plan of a path: at some location no direction is stable at any depth and speed");
  const bool has_single = std::isfinite(single.time);
  const double reference_depth = has_single ? single.depth : deepest;
  const double reference_time =
      has_single ? single.time : cutting_time(1, 1, area.table().speeds.back(), reference_depth);
  TimedPlan best;
  best.plan.cost = kInfinity;
  for (const double depth : depth_levels(has_single ? single.depth : 0.0, deepest)) {
    // Each layer changes direction anew, and there are more of them where they are thin.
    PatchCosts costs = costs_over(area, turning_cost * reference_depth / depth);
    costs.patch = [&](const GridRectangle& rectangle, int direction) {
      const std::vector<std::size_t> members = area.in(rectangle);
      const double speed = highest_speed(area, members, direction, depth);
      return cutting_time(members.size(), area.count(), speed, depth) / reference_time;
    };
    PatchPlan plan = plan_patches(costs);
    if (plan.cost < best.plan.cost) best = {std::move(plan), depth};
  }
  return best;
}

double line_or_border(const std::vector<double>& lines, int index) {
  if (index < 0) return -kInfinity;
  return index < static_cast<int>(lines.size()) ? lines[static_cast<std::size_t>(index)] : kInfinity;
}

// `depth`: what must be stable, then the highest such speed is taken; without it the speed of the deepest pocket.
PlannedPatch planned(const Area& area, const Patch& patch, std::optional<double> depth) {
  const GridRectangle& r = patch.rectangle;
  const LocationGrid& grid = area.grid();
  PlannedPatch result{line_or_border(grid.x_lines, r.column_begin - 1), line_or_border(grid.x_lines, r.column_end - 1),
                      line_or_border(grid.y_lines, r.row_begin - 1), line_or_border(grid.y_lines, r.row_end - 1)};
  result.direction = area.table().directions[static_cast<std::size_t>(patch.direction)];
  const std::vector<std::size_t> members = area.in(r);
  if (members.empty()) return result;
  const std::vector<double> common = area.common(members, patch.direction);
  const Pocket pocket = deepest_pocket(common, area.table().speeds);
  result.spindle_speed = depth ? highest_speed(area, members, patch.direction, *depth) : pocket.speed;
  const auto at = std::find(area.table().speeds.begin(), area.table().speeds.end(), result.spindle_speed);
  result.depth_limit = common[static_cast<std::size_t>(at - area.table().speeds.begin())];
  for (const std::size_t i : members) result.locations.push_back(area.location(i));
  return result;
}

}  // namespace

PathPlan plan_path(const DirectionTable& table, std::span<const std::size_t> used, const PlanSettings& settings) {
  if (used.empty()) throw std::invalid_argument("plan of a path: there are no locations");
  const Area area(table, used);
  PathPlan result;
  std::optional<double> depth;
  PatchPlan plan;
  if (settings.objective == PlanObjective::time) {
    const SingleDirection single = fastest_single(area);
    TimedPlan timed = plan_for_time(area, settings.turning_cost, single);
    plan = std::move(timed.plan);
    depth = timed.depth;
    result.single_cost = std::isfinite(single.time) ? 1.0 : kInfinity;
  } else {
    plan = plan_for_absolute(area, settings.turning_cost, result.single_cost);
  }
  result.cost = plan.cost;
  double limit = table.max_depth;
  for (const Patch& patch : plan.patches) {
    PlannedPatch piece = planned(area, patch, depth);
    // Where nothing was measured the patch before it says how to cut.
    if (piece.locations.empty() && !result.patches.empty()) piece.spindle_speed = result.patches.back().spindle_speed;
    if (!piece.locations.empty()) limit = std::min(limit, piece.depth_limit);
    result.patches.push_back(std::move(piece));
  }
  for (PlannedPatch& piece : result.patches)  // and what comes before the first measured one, the one after it
    if (piece.spindle_speed == 0.0)
      for (const PlannedPatch& other : result.patches)
        if (other.spindle_speed > 0.0 && piece.spindle_speed == 0.0) piece.spindle_speed = other.spindle_speed;
  result.axial_depth = (1.0 - settings.depth_margin) * limit;
  return result;
}

}  // namespace stillcut
