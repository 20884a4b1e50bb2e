#include "tools/pattern_study.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

#include "models/lobes.hpp"
#include "models/places.hpp"
#include "models/planned_path.hpp"
#include "tools/location_study.hpp"
#include "tools/pattern_paths.hpp"

namespace stillcut {
namespace {

constexpr int kSpeeds = 201;
constexpr double kHalfTurn = std::numbers::pi;

// The paper's projection has no meaning beyond a right angle (docs/directions.md).
double largest_direction(DirectionMethod method) {
  return method == DirectionMethod::paper ? 0.5 * kHalfTurn : kHalfTurn;
}

std::vector<double> grid_directions(const PatternQuestion& question) {
  const auto steps = static_cast<int>(std::round(largest_direction(question.method) / question.step));
  const int count = question.method == DirectionMethod::paper ? steps + 1 : steps;
  std::vector<double> directions;
  directions.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) directions.push_back(i * question.step);
  return directions;
}

std::vector<Eigen::Vector2d> places_of(const Cell& cell, const std::vector<PredictedPosture>& locations) {
  constexpr double kSamePlace = 1e-6;  // m
  std::vector<Eigen::Vector2d> places;
  places.reserve(locations.size());
  for (const PredictedPosture& location : locations) {
    const Eigen::Vector2d place(location.posture.position[0], location.posture.position[1]);
    for (std::size_t i = 0; i < places.size(); ++i) {
      if ((places[i] - place).norm() > kSamePlace) continue;
      throw InputError(
          require(cell, cell.dynamics, "dynamics").map.string(), 0,
          "postures " + locations[i].posture.id + " and " + location.posture.id +
              " have the same x_mm and y_mm, so that a path cannot tell which holds; choose with --posture");
    }
    places.push_back(place);
  }
  return places;
}

// By the paper's projection, paths that feed beyond a right angle cannot be rated.
void drop_what_cannot_be_rated(PatternStudy& study) {
  const double largest = largest_direction(study.question.method);
  std::erase_if(study.patterns, [&](const RatedPattern& pattern) {
    const bool beyond = std::any_of(pattern.on.cuts.begin(), pattern.on.cuts.end(),
                                    [&](const LocalCut& cut) { return cut.direction > largest + 1e-9; });
    if (beyond) study.warnings.push_back(pattern.name + " feeds beyond 90 degrees: not rated by --method paper");
    return beyond;
  });
}

// Directions between the table's own that paths take, location by location.
std::vector<LocationQuestion> questions_of(const std::vector<RatedPattern>& patterns, std::size_t locations) {
  std::vector<LocationQuestion> questions(locations);
  for (const RatedPattern& pattern : patterns) {
    for (const LocalCut& cut : pattern.on.cuts) {
      LocationQuestion& question = questions[cut.location];
      question.directions.push_back(cut.direction);
      if (cut.alternating) question.alternating_directions.push_back(cut.direction);
    }
  }
  return questions;
}

// The lowest limit that a path meets anywhere, each move at its own speed, m. Where locations do not stand in columns
// and rows, a patch holds parts that belong to its neighbours' locations.
double lowest_limit_along(const DirectionTable& table, const ToolPath& path,
                          const std::vector<Eigen::Vector2d>& places) {
  constexpr double kPiece = 2e-3;  // m
  double lowest = table.max_depth;
  for (const PathMove& move : path.moves) {
    const Eigen::Vector2d from = move.from.head<2>(), way = move.to.head<2>() - from;
    if (!move.cutting || way.norm() < 1e-9) continue;
    const double direction = std::atan2(way.y(), way.x());
    const int pieces = std::max(1, static_cast<int>(std::ceil(way.norm() / kPiece)));
    std::size_t before = places.size();
    for (int i = 0; i < pieces; ++i) {
      const std::size_t location = nearest_place(from + way * ((i + 0.5) / pieces), places);
      if (location == before) continue;
      before = location;
      lowest = std::min(lowest, limit_along(table, location, direction, move.spindle_speed));
    }
  }
  return lowest;
}

// A path whose patches have speeds of their own, at the depth that they all allow.
void rate_plan(const PatternStudy& study, double depth, RatedPattern& planned) {
  double cutting_time = 0.0;
  for (const PathMove& move : planned.path.moves)
    if (move.cutting) cutting_time += (move.to - move.from).norm() / move.feed_rate;
  const double time = cutting_time + planned.on.air_length / study.conditions.rapid_rate;
  planned.rating.time_per_depth = depth > 0.0 ? time / depth : kInfinity;
  planned.rating.common = {depth, study.plan.patches.front().spindle_speed};
  planned.rating.removal_rate = depth * study.conditions.radial_depth * planned.on.cutting_length / cutting_time;
}

void optimize(const Cell& cell, PatternStudy& study, const std::vector<Eigen::Vector2d>& places) {
  const PlanSettings& settings = study.question.plan;
  const bool by_time = settings.objective == PlanObjective::time;
  study.plan = plan_path(study.table, used_locations(study.patterns), settings);
  RatedPattern planned{
      "optimized", PatternSource::plan, cell.file.string(),
      planned_path(*cell.region, study.plan, pattern_settings(cell, study.question), study.conditions)};
  planned.on = path_on_locations(planned.path, places);
  planned.rating = rate_path(study.table, planned.on, study.conditions);
  const double depth = std::min(study.plan.axial_depth / (1.0 - settings.depth_margin),
                                lowest_limit_along(study.table, planned.path, places));
  study.plan.axial_depth = (1.0 - settings.depth_margin) * depth;
  rate_plan(study, depth, planned);
  study.made_of = std::to_string(study.plan.patches.size()) + (study.plan.patches.size() == 1 ? " patch" : " patches");
  study.optimized = std::move(planned);

  // A path from a file need not fill the region: only patterns that do are compared.
  const auto worth = [&](const RatedPattern& p) { return by_time ? -p.rating.time_per_depth : p.rating.asi; };
  const RatedPattern* single = nullptr;
  for (const RatedPattern& pattern : study.patterns) {
    const bool fills = pattern.source != PatternSource::file;
    if (fills && (single == nullptr || worth(pattern) > worth(*single))) single = &pattern;
  }
  if (single == nullptr || !(worth(*single) > worth(study.optimized))) return;
  study.made_of = single->name;
  study.optimized = *single;
  study.optimized.name = "optimized";
  study.plan.patches.clear();
  study.plan.axial_depth = (1.0 - settings.depth_margin) * single->rating.common.depth;
}

void collect_warnings(const Cell& cell, const std::vector<PredictedPosture>& locations, PatternStudy& study) {
  std::set<std::string> told;
  for (const PredictedPosture& location : locations)
    for (const std::string& line : stability_warnings(require(cell, cell.tool, "tool"), study.question.cut, location))
      if (told.insert(line).second) study.warnings.push_back(line);
  for (const std::string& line : path_warnings(cell, study.question, study.patterns)) study.warnings.push_back(line);
  std::string never;
  for (const LocationLimits& location : study.table.locations)
    if (best_absolute_limit(study.table, location) == 0.0) never += (never.empty() ? "" : ", ") + location.posture;
  if (!never.empty()) {
    study.warnings.push_back("at some speed of [spindle] no direction is stable at any depth at " + never +
                             ": left out of the index");
  }
}

}  // namespace

PatternStudy study_patterns(const Cell& cell, const PatternQuestion& question,
                            const std::function<void(double)>& progress) {
  PatternStudy study;
  study.question = question;
  study.region = cell.region;
  const Tool& tool = require(cell, cell.tool, "tool");
  const SpindleLimits& spindle = require(cell, cell.spindle, "spindle");
  study.conditions = {tool.teeth, question.cut.feed_per_tooth, question.cut.radial_depth, question.rapid_rate};
  study.table.directions = grid_directions(question);
  study.table.speeds = equally_spaced_speeds(spindle.min_speed, spindle.max_speed, kSpeeds);
  study.table.max_depth = question.max_depth;

  const CellDynamics dynamics = read_cell_dynamics(cell);
  const std::vector<PredictedPosture> locations = study_locations(cell, dynamics, question.postures, question.grid);
  const std::vector<Eigen::Vector2d> places = places_of(cell, locations);
  study.patterns = paths_to_rank(cell, question, study.table.directions, places);
  check_covered(study.patterns, places, question.reach);
  drop_what_cannot_be_rated(study);
  if (study.patterns.empty())
    throw InputError(cell.file.string(), 0, "no path is left to rate: " + study.warnings.back());
  solve_table(cell, question.cut, question.method, locations, questions_of(study.patterns, places.size()),
              question.threads, progress, study.table);
  for (RatedPattern& pattern : study.patterns) pattern.rating = rate_path(study.table, pattern.on, study.conditions);
  std::stable_sort(study.patterns.begin(), study.patterns.end(), [](const RatedPattern& a, const RatedPattern& b) {
    return a.rating.asi > b.rating.asi || (std::isnan(b.rating.asi) && !std::isnan(a.rating.asi));
  });

  study.field = direction_field(study.table, question.near_optimal);
  std::vector<double> chosen;
  chosen.reserve(study.field.locations.size());
  for (const ChosenDirection& choice : study.field.locations) chosen.push_back(choice.chosen);
  study.local_pocket = common_pocket(study.table, chosen);
  study.global = global_choice(study.table, study.field);
  try {
    if (cell.region) optimize(cell, study, places);
  } catch (const std::invalid_argument& error) {
    throw InputError(cell.file.string(), 0, error.what());
  }
  collect_warnings(cell, locations, study);
  return study;
}

const RatedPattern& pattern_named(const PatternStudy& study, const std::string& name) {
  const bool planned = !study.optimized.path.moves.empty();
  if (name == "optimized" && planned) return study.optimized;
  const auto found = std::find_if(study.patterns.begin(), study.patterns.end(),
                                  [&](const RatedPattern& pattern) { return pattern.name == name; });
  if (found != study.patterns.end()) return *found;
  throw std::invalid_argument("there is no pattern \"" + name + "\"; there are, for example, " +
                              (planned ? "\"optimized\", " : "") + "\"" + study.patterns.front().name + "\" and \"" +
                              study.patterns.back().name + "\"");
}

double limit_along(const DirectionTable& table, std::size_t location, double direction, double spindle_speed,
                   bool to_and_fro) {
  const LocationLimits& limits = table.locations[location];
  const std::vector<DirectionCurve>& curves =
      to_and_fro && !limits.alternating.empty() ? limits.alternating : limits.curves;
  const auto speed = std::lower_bound(table.speeds.begin(), table.speeds.end(), spindle_speed * (1.0 - 1e-9));
  const auto s = std::min(static_cast<std::size_t>(speed - table.speeds.begin()), table.speeds.size() - 1);
  const DirectionCurve* nearest[2] = {nullptr, nullptr};  // on either side
  for (const DirectionCurve& curve : curves) {
    const double turn = std::remainder(curve.direction - direction, kHalfTurn);
    if (std::abs(turn) < 1e-9) return std::min(curve.limits[s], table.max_depth);
    const DirectionCurve*& side = nearest[turn > 0.0];
    if (side == nullptr || axis_angle(curve.direction, direction) < axis_angle(side->direction, direction))
      side = &curve;
  }
  double limit = table.max_depth;
  for (const DirectionCurve* curve : nearest)
    if (curve != nullptr) limit = std::min(limit, curve->limits[s]);
  return limit;
}

}  // namespace stillcut
