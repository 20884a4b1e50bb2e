#include "tools/pattern_study.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>
#include <stdexcept>

#include "drivers/files/csv.hpp"
#include "drivers/files/tool_path_file.hpp"
#include "models/lobes.hpp"
#include "models/path_patterns.hpp"
#include "models/planned_path.hpp"
#include "tools/location_study.hpp"

namespace stillcut {
namespace {

constexpr int kSpeeds = 201;
constexpr double kHalfTurn = std::numbers::pi;

PatternSettings pattern_settings(const Cell& cell, const PatternQuestion& question) {
  PatternSettings settings;
  settings.tool_radius = 0.5 * require(cell, cell.tool, "tool").diameter;
  settings.step_over = question.cut.step_over > 0.0 ? question.cut.step_over : question.cut.radial_depth;
  settings.milling = question.cut.milling == Milling::up ? Milling::up : Milling::down;
  settings.face = question.face;
  return settings;
}

std::vector<double> grid_directions(const PatternQuestion& question) {
  // The paper's projection has no meaning beyond a right angle (docs/directions.md).
  const bool quarter = question.method == DirectionMethod::paper;
  const auto count =
      static_cast<int>(std::round((quarter ? 0.5 : 1.0) * kHalfTurn / question.step)) + (quarter ? 1 : 0);
  std::vector<double> directions;
  for (int i = 0; i < count; ++i) directions.push_back(i * question.step);
  return directions;
}

std::vector<ToolPath> region_patterns(const Cell& cell, const PatternQuestion& question,
                                      const std::vector<double>& angles) {
  const PatternSettings settings = pattern_settings(cell, question);
  const Region& region = require(cell, cell.region, "region");
  std::vector<ToolPath> paths;
  try {
    for (const PatternKind kind : {PatternKind::zig, PatternKind::zig_zag})
      for (const double angle : angles) paths.push_back(make_pattern(region, kind, angle, settings));
    for (const PatternKind kind :
         {PatternKind::periphery_in, PatternKind::periphery_out, PatternKind::spiral_in, PatternKind::spiral_out})
      paths.push_back(make_pattern(region, kind, 0.0, settings));
  } catch (const std::invalid_argument& error) {
    throw InputError(cell.file.string(), 0, std::string("[region] ") + error.what());
  }
  return paths;
}

std::string in_mm(double metres) { return csv_number(std::round(metres * 1e4) / 10.0) + " mm"; }

// Of the locations that paths come to, so that a posture far away from all of this makes nothing seem near.
double reach_of_used(const std::vector<RatedPattern>& patterns, const std::vector<Eigen::Vector2d>& places) {
  std::set<std::size_t> used;
  for (const RatedPattern& pattern : patterns)
    for (const LocalCut& cut : pattern.on.cuts) used.insert(cut.location);
  std::vector<Eigen::Vector2d> used_places;
  for (const std::size_t i : used) used_places.push_back(places[i]);
  return used_places.size() > 1 ? reach_of(used_places) : reach_of(places);
}

void check_covered(const Cell& cell, const RatedPattern& pattern, double reach) {
  if (pattern.on.farthest <= reach) return;
  throw InputError(cell.file.string(), 0,
                   pattern.name + " goes to (" + in_mm(pattern.on.farthest_place.x()) + ", " +
                       in_mm(pattern.on.farthest_place.y()) + "), " + in_mm(pattern.on.farthest) +
                       " from the nearest posture of the map, which speaks for " + in_mm(reach) +
                       " around it; measure there, or say with --reach how far a posture holds");
}

// Where the postures lie one above the other, or in a map of joints without places, nothing tells them apart.
void check_places(const Cell& cell, const std::vector<Eigen::Vector2d>& places) {
  for (std::size_t i = 1; i < places.size(); ++i)
    if ((places[i] - places[0]).norm() > 1e-6) return;
  if (places.size() < 2) return;
  throw InputError(require(cell, cell.dynamics, "dynamics").map.string(), 0,
                   "all postures have the same x_mm and y_mm; give each the place of its tool point");
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

// Files that only differ in folder, or are called like a pattern, stay apart.
std::string path_name(const std::filesystem::path& file, const std::set<std::string>& taken) {
  const std::string name = file.stem().string();
  return taken.contains(name) ? file.string() : name;
}

std::vector<std::size_t> used_locations(const std::vector<RatedPattern>& patterns) {
  std::set<std::size_t> used;
  for (const RatedPattern& pattern : patterns)
    for (const LocalCut& cut : pattern.on.cuts) used.insert(cut.location);
  return {used.begin(), used.end()};
}

// A path whose patches have speeds of their own, at the depth that they all allow.
void rate_plan(const PathPlan& plan, double depth_margin, const CuttingConditions& conditions, RatedPattern& planned) {
  double time = planned.on.air_length / conditions.rapid_rate;
  for (const PathMove& move : planned.path.moves)
    if (move.cutting) time += (move.to - move.from).norm() / move.feed_rate;
  const double depth = plan.axial_depth / (1.0 - depth_margin);
  planned.rating.time_per_depth = depth > 0.0 ? time / depth : kInfinity;
  planned.rating.common.depth = depth;
  planned.rating.common.speed = plan.patches.front().spindle_speed;
  planned.rating.removal_rate = depth * conditions.radial_depth * planned.on.cutting_length / time;
}

void optimize(const Cell& cell, PatternStudy& study, const std::vector<Eigen::Vector2d>& places) {
  const PlanSettings& settings = study.question.plan;
  const bool by_time = settings.objective == PlanObjective::time;
  study.plan = plan_path(study.table, used_locations(study.patterns), settings);
  const PatternSettings pattern = pattern_settings(cell, study.question);
  RatedPattern planned{"optimized", planned_path(*cell.region, study.plan, pattern, study.conditions), {}, {}};
  planned.on = path_on_locations(planned.path, places);
  planned.rating = rate_path(study.table, planned.on, study.conditions);
  rate_plan(study.plan, settings.depth_margin, study.conditions, planned);
  const auto worth = [&](const RatedPattern& p) { return by_time ? -p.rating.time_per_depth : p.rating.asi; };
  const auto single =
      std::max_element(study.patterns.begin(), study.patterns.end(),
                       [&](const RatedPattern& a, const RatedPattern& b) { return worth(a) < worth(b); });
  study.made_of = std::to_string(study.plan.patches.size()) + (study.plan.patches.size() == 1 ? " patch" : " patches");
  study.optimized = std::move(planned);
  if (!(worth(*single) > worth(study.optimized))) return;
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
  const std::vector<PredictedPosture> locations = study_locations(cell, dynamics, question.grid);
  std::vector<Eigen::Vector2d> places;
  for (const PredictedPosture& location : locations)
    places.emplace_back(location.posture.position[0], location.posture.position[1]);
  check_places(cell, places);

  if (cell.region || question.paths.empty())
    for (ToolPath& path : region_patterns(cell, question, study.table.directions))
      study.patterns.push_back({path.name, path, {}, {}});
  std::set<std::string> names;
  for (const RatedPattern& pattern : study.patterns) names.insert(pattern.name);
  for (const std::filesystem::path& file : question.paths) {
    ToolPath path = read_tool_path(file);
    path.name = path_name(file, names);
    names.insert(path.name);
    study.patterns.push_back({path.name, std::move(path), {}, {}});
  }
  for (RatedPattern& pattern : study.patterns) {
    pattern.on = path_on_locations(pattern.path, places);
    if (pattern.on.cuts.empty())
      throw InputError(pattern.name, 0, "cuts nowhere in the plane: it has no feed move across X and Y");
  }
  const double reach = question.reach.value_or(reach_of_used(study.patterns, places));
  for (const RatedPattern& pattern : study.patterns) check_covered(cell, pattern, reach);
  solve_table(cell, question.cut, question.method, locations, questions_of(study.patterns, places.size()),
              question.threads, progress, study.table);
  for (RatedPattern& pattern : study.patterns) pattern.rating = rate_path(study.table, pattern.on, study.conditions);
  std::stable_sort(study.patterns.begin(), study.patterns.end(), [](const RatedPattern& a, const RatedPattern& b) {
    return a.rating.asi > b.rating.asi || (std::isnan(b.rating.asi) && !std::isnan(a.rating.asi));
  });

  study.field = direction_field(study.table, question.near_optimal);
  std::vector<double> chosen;
  for (const ChosenDirection& choice : study.field.locations) chosen.push_back(choice.chosen);
  study.local_pocket = common_pocket(study.table, chosen);
  study.global = global_choice(study.table, study.field);
  if (cell.region) optimize(cell, study, places);
  collect_warnings(cell, locations, study);
  return study;
}

const RatedPattern& pattern_named(const PatternStudy& study, const std::string& name) {
  if (name == "optimized" && !study.optimized.path.moves.empty()) return study.optimized;
  const auto found = std::find_if(study.patterns.begin(), study.patterns.end(),
                                  [&](const RatedPattern& pattern) { return pattern.name == name; });
  if (found != study.patterns.end()) return *found;
  throw std::invalid_argument("there is no pattern \"" + name + "\"; there are, for example, \"optimized\", \"" +
                              study.patterns.front().name + "\" and \"" + study.patterns.back().name + "\"");
}

double limit_along(const DirectionTable& table, std::size_t location, double direction, double spindle_speed) {
  const std::vector<DirectionCurve>& curves = table.locations[location].curves;
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
