// How ranked patterns are written: CSV and JSON for programs, a table for people. Declared in pattern_study.hpp.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <ostream>
#include <set>

#include "drivers/files/csv.hpp"
#include "tools/as_given.hpp"
#include "tools/pattern_study.hpp"

namespace stillcut {
namespace {

constexpr double kCm3PerMin = 1e6 * 60.0;  // of m^3/s

nlohmann::ordered_json number_or_null(double value) {
  return std::isfinite(value) ? nlohmann::ordered_json(as_given(value)) : nullptr;
}

std::size_t locations_of(const RatedPattern& pattern) {
  std::set<std::size_t> locations;
  for (const LocalCut& cut : pattern.on.cuts) locations.insert(cut.location);
  return locations.size();
}

nlohmann::ordered_json pattern_json(const RatedPattern& pattern) {
  const PatternRating& rating = pattern.rating;
  return {{"name", pattern.name},
          {"asi_percent", number_or_null(100.0 * rating.asi)},
          {"msi_percent", number_or_null(100.0 * rating.msi)},
          {"min_a_abs_mm", as_given_mm(rating.min_absolute)},
          {"max_a_abs_mm", as_given_mm(rating.max_absolute)},
          {"pocket_rpm", as_given_rpm(rating.common.speed)},
          {"a_pocket_mm", as_given_mm(rating.common.depth)},
          {"removal_rate_cm3_per_min", as_given(rating.removal_rate * kCm3PerMin)},
          {"time_s_per_mm", number_or_null(rating.time_per_depth * 1e-3)},
          {"cutting_length_mm", as_given_mm(pattern.on.cutting_length)},
          {"locations", locations_of(pattern)}};
}

nlohmann::ordered_json pocket_json(const Pocket& pocket) {
  return {{"pocket_rpm", as_given_rpm(pocket.speed)}, {"a_pocket_mm", as_given_mm(pocket.depth)}};
}

nlohmann::ordered_json location_json(const PatternStudy& study, std::size_t i) {
  const ChosenDirection& choice = study.field.locations[i];
  const LocationLimits& location = study.table.locations[i];
  nlohmann::ordered_json near = nlohmann::json::array();
  for (std::size_t d = 0; d < choice.near.size(); ++d)
    if (choice.near[d]) near.push_back(as_given_deg(study.table.directions[d]));
  return {{"posture", location.posture},
          {"x_mm", as_given_mm(location.place.x())},
          {"y_mm", as_given_mm(location.place.y())},
          {"best_direction_deg", as_given_deg(choice.best)},
          {"near_optimal_deg", near},
          {"outlier", choice.outlier},
          {"chosen_direction_deg", as_given_deg(choice.chosen)},
          {"a_abs_mm",
           as_given_mm(bounded_absolute_limit(curve_at(location.curves, choice.chosen), study.table.max_depth))},
          {"group", choice.group + 1},
          {"common_pocket_direction_deg", as_given_deg(study.global.directions[i])}};
}

nlohmann::ordered_json plan_json(const PatternStudy& study) {
  nlohmann::ordered_json result = pattern_json(study.optimized);
  result["made_of"] = study.made_of;
  result["objective"] = study.question.plan.objective == PlanObjective::time ? "time" : "asi";
  result["axial_depth_mm"] = as_given_mm(study.plan.axial_depth);
  const auto border = [](double metres) { return number_or_null(metres * 1e3); };
  nlohmann::ordered_json patches = nlohmann::json::array();
  for (const PlannedPatch& patch : study.plan.patches) {
    nlohmann::ordered_json postures = nlohmann::json::array();
    for (const std::size_t i : patch.locations) postures.push_back(study.table.locations[i].posture);
    patches.push_back({{"x_mm", {border(patch.x_begin), border(patch.x_end)}},
                       {"y_mm", {border(patch.y_begin), border(patch.y_end)}},
                       {"feed_direction_deg", as_given_deg(patch.direction)},
                       {"spindle_speed_rpm", as_given_rpm(patch.spindle_speed)},
                       {"a_lim_mm", as_given_mm(patch.depth_limit)},
                       {"postures", postures}});
  }
  result["patches"] = patches;
  return result;
}

std::string fixed(double value, int digits, int width) {
  char text[48];
  if (std::isfinite(value)) {
    std::snprintf(text, sizeof text, "%*.*f", width, digits, value);
  } else {
    std::snprintf(text, sizeof text, "%*s", width, "–");
  }
  return text;
}

std::string row_text(const RatedPattern& pattern) {
  const PatternRating& rating = pattern.rating;
  char name[80];
  std::snprintf(name, sizeof name, "  %-16s", pattern.name.c_str());
  return name + fixed(100.0 * rating.asi, 1, 6) + fixed(100.0 * rating.msi, 1, 8) +
         fixed(rating.min_absolute * 1e3, 3, 9) + fixed(rating.max_absolute * 1e3, 3, 9) +
         fixed(rating.common.depth * 1e3, 3, 9) + fixed(rad_s_to_rpm(rating.common.speed), 0, 9) +
         fixed(rating.removal_rate * kCm3PerMin, 2, 10) + fixed(rating.time_per_depth * 1e-3 / 60.0, 1, 10) + "\n";
}

std::string degrees(double direction) { return csv_number(as_given_deg(direction)) + "°"; }

std::string pocket_text(const Pocket& pocket) {
  return fixed(pocket.depth * 1e3, 3, 0) + " mm at " + fixed(rad_s_to_rpm(pocket.speed), 0, 0) + " rpm";
}

}  // namespace

void write_patterns_csv(const PatternStudy& study, std::ostream& out) {
  out << "name,asi_percent,msi_percent,min_a_abs_mm,max_a_abs_mm,pocket_rpm,a_pocket_mm,removal_rate_cm3_per_min,"
         "time_s_per_mm,cutting_length_mm\n";
  const auto number = [](double value) { return std::isfinite(value) ? csv_number(value) : std::string(); };
  for (const RatedPattern& pattern : study.patterns) {
    const PatternRating& rating = pattern.rating;
    write_csv_row(
        out, std::vector<std::string>{csv_text(pattern.name), number(100.0 * rating.asi), number(100.0 * rating.msi),
                                      number(rating.min_absolute * 1e3), number(rating.max_absolute * 1e3),
                                      number(as_given_rpm(rating.common.speed)), number(rating.common.depth * 1e3),
                                      number(rating.removal_rate * kCm3PerMin), number(rating.time_per_depth * 1e-3),
                                      number(pattern.on.cutting_length * 1e3)});
  }
}

nlohmann::ordered_json patterns_json(const PatternStudy& study) {
  nlohmann::ordered_json patterns = nlohmann::json::array(), locations = nlohmann::json::array();
  for (const RatedPattern& pattern : study.patterns) patterns.push_back(pattern_json(pattern));
  for (std::size_t i = 0; i < study.table.locations.size(); ++i) locations.push_back(location_json(study, i));
  nlohmann::ordered_json groups = nlohmann::json::array();
  for (const DirectionGroup& group : study.field.groups) {
    nlohmann::ordered_json postures = nlohmann::json::array();
    for (const std::size_t i : group.locations) postures.push_back(study.table.locations[i].posture);
    groups.push_back({{"feed_direction_deg", as_given_deg(group.direction)}, {"postures", postures}});
  }
  nlohmann::ordered_json result{{"patterns", patterns},
                                {"locations", locations},
                                {"groups", groups},
                                {"local_choice", pocket_json(study.local_pocket)},
                                {"global_choice", pocket_json(study.global.common)},
                                {"max_depth_mm", as_given_mm(study.table.max_depth)}};
  if (!study.optimized.path.moves.empty()) result["optimized"] = plan_json(study);
  return result;
}

void print_patterns(const PatternStudy& study, std::ostream& out) {
  constexpr int kLinePatternsShown = 8;
  out << "  pattern          ASI %   MSI %  min mm   max mm  pocket mm    rpm   cm³/min   min/mm\n";
  int lines = 0, left_out = 0;
  for (const RatedPattern& pattern : study.patterns) {
    const bool shown = !(pattern.source == PatternSource::lines) || lines < kLinePatternsShown;
    if ((pattern.source == PatternSource::lines)) ++lines;
    shown ? void(out << row_text(pattern)) : void(++left_out);
  }
  if (left_out > 0) out << "  and " << left_out << " more zig and zig-zag below these (--csv lists them)\n";
  out << "  min and max: a_abs along the pattern; pocket: what all its locations allow at one speed\n\n";
  out << "Directions: one serves " << study.field.groups.front().locations.size() << " of "
      << study.table.locations.size() << " locations nearly as well as the best, "
      << degrees(study.field.groups.front().direction) << "; " << study.field.groups.size() << " group"
      << (study.field.groups.size() == 1 ? "" : "s") << " in all. Each location's own: in common "
      << pocket_text(study.local_pocket) << "; chosen for the common pocket: " << pocket_text(study.global.common)
      << "\n";
  if (study.optimized.path.moves.empty()) return;
  out << "Optimized: " << study.made_of << "\n" << row_text(study.optimized);
  for (const PlannedPatch& patch : study.plan.patches) {
    const auto border = [](double metres) {
      return std::isfinite(metres) ? csv_number(as_given_mm(metres)) : std::string("border");
    };
    out << "    X " << border(patch.x_begin) << " to " << border(patch.x_end) << ", Y " << border(patch.y_begin)
        << " to " << border(patch.y_end) << ": " << degrees(patch.direction) << " at "
        << fixed(rad_s_to_rpm(patch.spindle_speed), 0, 0) << " rpm, stable below "
        << fixed(patch.depth_limit * 1e3, 3, 0) << " mm\n";
  }
}

void write_feed_map(const PatternStudy& study, std::ostream& out) {
  out << "x_mm,y_mm,feed_direction_deg,spindle_speed_rpm,a_lim_mm\n";
  const auto row = [&](std::size_t i, double direction, double speed, double depth) {
    const LocationLimits& location = study.table.locations[i];
    write_csv_row(
        out, std::vector<std::string>{csv_number(as_given_mm(location.place.x())),
                                      csv_number(as_given_mm(location.place.y())), csv_number(as_given_deg(direction)),
                                      csv_number(as_given_rpm(speed)), csv_number(depth * 1e3)});
  };
  std::set<std::size_t> written;
  if (!study.plan.patches.empty()) {
    for (const PlannedPatch& patch : study.plan.patches)
      for (const std::size_t i : patch.locations) row(i, patch.direction, patch.spindle_speed, patch.depth_limit);
    return;
  }
  const RatedPattern& pattern = study.optimized.path.moves.empty() ? study.patterns.front() : study.optimized;
  for (const LocalCut& cut : pattern.on.cuts) {
    const bool most = std::none_of(pattern.on.cuts.begin(), pattern.on.cuts.end(), [&](const LocalCut& other) {
      return other.location == cut.location && other.share > cut.share;
    });
    if (most && written.insert(cut.location).second)
      row(cut.location, cut.direction, pattern.rating.common.speed, pattern.rating.common.depth);
  }
}

}  // namespace stillcut
