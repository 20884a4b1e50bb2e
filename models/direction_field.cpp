#include "models/direction_field.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "dsp/numbers.hpp"
#include "models/places.hpp"

namespace stillcut {
namespace {

using Neighbours = std::vector<std::vector<std::size_t>>;

Neighbours neighbours_of(const DirectionTable& table) {
  constexpr double kOfReach = 1.5;  // a square grid's diagonals are 1.41 spacings long
  std::vector<Eigen::Vector2d> places;
  for (const LocationLimits& location : table.locations) places.push_back(location.place);
  const double reach = kOfReach * reach_of(places);
  Neighbours neighbours(places.size());
  for (std::size_t i = 0; i < places.size(); ++i)
    for (std::size_t j = 0; j < places.size(); ++j)
      if (i != j && (places[i] - places[j]).norm() <= reach) neighbours[i].push_back(j);
  return neighbours;
}

ChosenDirection best_of(const LocationLimits& location, const DirectionTable& table, double tolerance) {
  std::vector<double> limits;
  for (const double direction : table.directions)
    limits.push_back(bounded_absolute_limit(curve_at(location.curves, direction), table.max_depth));
  const auto best = std::max_element(limits.begin(), limits.end());
  ChosenDirection choice;
  choice.best = choice.chosen = table.directions[static_cast<std::size_t>(best - limits.begin())];
  for (const double limit : limits) choice.near.push_back(limit >= (1.0 - tolerance) * *best);
  return choice;
}

// The axis from which the others are least far in all: a median that knows that 179 and 1 degree are neighbours.
double median_axis(const std::vector<double>& axes) {
  const auto distance = [&](double axis) {
    double sum = 0.0;
    for (const double other : axes) sum += axis_angle(axis, other);
    return sum;
  };
  double median = axes.front(), least = distance(median);
  for (const double axis : axes) {
    const double sum = distance(axis);
    if (sum < least) least = sum, median = axis;
  }
  return median;
}

// What the neighbours prefer: their median and how far from it three quarters of them lie.
struct Range {
  double middle = 0.0, half_width = 0.0;
};

Range range_of(const std::vector<double>& axes) {
  Range range{median_axis(axes)};
  std::vector<double> distances;
  distances.reserve(axes.size());
  for (const double axis : axes) distances.push_back(axis_angle(axis, range.middle));
  std::sort(distances.begin(), distances.end());
  range.half_width = distances[(3 * distances.size() - 1) / 4];
  return range;
}

// An outlier lies beyond the range of its neighbours, by more than the table's step can tell. Those that were brought
// back are neighbours to others, so it is done again until nothing moves.
void smooth_outliers(DirectionField& field, const std::vector<double>& directions, const Neighbours& neighbours) {
  constexpr std::size_t kFewestForARange = 3;
  constexpr int kMostRounds = 20;
  const double step = directions.size() > 1 ? directions[1] - directions[0] : 0.0;
  bool moved = true;
  for (int round = 0; moved && round < kMostRounds; ++round) {
    moved = false;
    for (std::size_t i = 0; i < field.locations.size(); ++i) {
      ChosenDirection& choice = field.locations[i];
      if (neighbours[i].size() < kFewestForARange) continue;
      std::vector<double> axes;
      for (const std::size_t j : neighbours[i]) axes.push_back(field.locations[j].chosen);
      const Range range = range_of(axes);
      if (axis_angle(choice.chosen, range.middle) <= range.half_width + 0.5 * step) continue;
      choice.outlier = true;
      const double before = choice.chosen;
      for (std::size_t d = 0; d < directions.size(); ++d) {
        const bool nearer = axis_angle(directions[d], range.middle) < axis_angle(choice.chosen, range.middle) - 1e-9;
        if (choice.near[d] && nearer) choice.chosen = directions[d];
      }
      moved = moved || choice.chosen != before;
    }
  }
}

// The locations reached from `start` through neighbours that are free and served by direction d.
std::vector<std::size_t> connected(std::size_t start, std::size_t d, const DirectionField& field,
                                   const std::vector<bool>& taken, const Neighbours& neighbours) {
  std::vector<std::size_t> found{start};
  std::vector<bool> seen(taken);
  seen[start] = true;
  for (std::size_t next = 0; next < found.size(); ++next) {
    for (const std::size_t j : neighbours[found[next]]) {
      if (seen[j] || !field.locations[j].near[d]) continue;
      seen[j] = true;
      found.push_back(j);
    }
  }
  std::sort(found.begin(), found.end());
  return found;
}

// How far a direction lies from what its locations would choose, in all.
double strain(const DirectionGroup& group, const DirectionField& field) {
  double sum = 0.0;
  for (const std::size_t i : group.locations) sum += axis_angle(group.direction, field.locations[i].chosen);
  return sum;
}

// The largest group first, then the largest of what is left, until every location is in one.
void gather_groups(DirectionField& field, const std::vector<double>& directions, const Neighbours& neighbours) {
  std::vector<bool> taken(field.locations.size(), false);
  while (std::find(taken.begin(), taken.end(), false) != taken.end()) {
    DirectionGroup best;
    for (std::size_t d = 0; d < directions.size(); ++d) {
      std::vector<bool> looked_at(taken);
      for (std::size_t i = 0; i < taken.size(); ++i) {
        if (looked_at[i] || !field.locations[i].near[d]) continue;
        DirectionGroup group{directions[d], connected(i, d, field, taken, neighbours)};
        for (const std::size_t member : group.locations) looked_at[member] = true;
        const bool larger = group.locations.size() > best.locations.size();
        const bool as_large = group.locations.size() == best.locations.size();
        if (larger || (as_large && strain(group, field) < strain(best, field))) best = group;
      }
    }
    for (const std::size_t member : best.locations) {
      taken[member] = true;
      field.locations[member].group = field.groups.size();
    }
    field.groups.push_back(best);
  }
}

}  // namespace

DirectionField direction_field(const DirectionTable& table, double tolerance) {
  if (!(tolerance >= 0.0 && tolerance <= 1.0)) throw std::invalid_argument("tolerance of directions: 0 to 1");
  DirectionField field;
  for (const LocationLimits& location : table.locations) field.locations.push_back(best_of(location, table, tolerance));
  const Neighbours neighbours = neighbours_of(table);
  smooth_outliers(field, table.directions, neighbours);
  gather_groups(field, table.directions, neighbours);
  return field;
}

Pocket common_pocket(const DirectionTable& table, const std::vector<double>& directions) {
  std::vector<const DirectionCurve*> curves;
  for (std::size_t i = 0; i < directions.size(); ++i)
    curves.push_back(&curve_at(table.locations[i].curves, directions[i]));
  return deepest_pocket(common_limits(curves, table.max_depth), table.speeds);
}

GlobalChoice global_choice(const DirectionTable& table, const DirectionField& field) {
  std::vector<double> common(table.speeds.size(), table.max_depth);
  for (const LocationLimits& location : table.locations) {
    for (std::size_t s = 0; s < common.size(); ++s) {
      double best = 0.0;
      for (const double direction : table.directions)
        best = std::max(best, curve_at(location.curves, direction).limits[s]);
      common[s] = std::min(common[s], best);
    }
  }
  GlobalChoice choice{deepest_pocket(common, table.speeds), {}};
  const auto speed = std::find(table.speeds.begin(), table.speeds.end(), choice.common.speed) - table.speeds.begin();
  for (std::size_t i = 0; i < table.locations.size(); ++i) {
    const double local = field.locations[i].chosen;
    double chosen = local;
    double turn = kInfinity;
    for (const double direction : table.directions) {
      const double limit = curve_at(table.locations[i].curves, direction).limits[static_cast<std::size_t>(speed)];
      if (limit >= choice.common.depth && axis_angle(direction, local) < turn) {
        turn = axis_angle(direction, local);
        chosen = direction;
      }
    }
    choice.directions.push_back(chosen);
  }
  return choice;
}

}  // namespace stillcut
