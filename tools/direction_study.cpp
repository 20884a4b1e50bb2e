#include "tools/direction_study.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <iomanip>
#include <nlohmann/json.hpp>
#include <optional>
#include <ostream>
#include <set>
#include <stdexcept>

#include "drivers/files/csv.hpp"
#include "tools/as_given.hpp"
#include "tools/tasks_on_threads.hpp"

namespace stillcut {
namespace {

nlohmann::ordered_json depth_json(double depth) {
  if (std::isfinite(depth)) return as_given(depth * 1e3);
  return csv_number(depth);
}

std::string depth_text(double depth, double max_depth) {
  std::ostringstream text;
  text << std::setprecision(3);
  if (std::isinf(depth)) {
    text << "over " << max_depth * 1e3 << " mm";
  } else {
    text << depth * 1e3 << " mm";
  }
  return text.str();
}

std::string degrees_text(double direction) { return csv_number(as_given(rad_to_deg(direction))) + "°"; }

// A posture with a variation, or why the robot cannot stand so.
struct Attempt {
  std::optional<PostureDirections> found;
  std::string refusal;
};

std::string variation_text(const Variation& variation) {
  return "redundancy " + degrees_text(variation.redundancy) + ", part moved by " +
         csv_number(as_given(1e3 * variation.x)) + ", " + csv_number(as_given(1e3 * variation.y)) + " mm";
}

// What the reader has to know of all of them. Variations by the hundred: the worst fit and the first outside speak for
// them all.
std::vector<std::string> warnings_of(const Tool& tool, const Cut& cut, const std::vector<PostureDirections>& postures,
                                     bool varied) {
  std::vector<std::string> lines;
  std::set<std::string> told;
  const auto tell = [&](const PredictedPosture& predicted) {
    for (const std::string& line : stability_warnings(tool, cut, predicted))
      if (told.insert(line).second) lines.push_back(line);
  };
  if (!varied) {
    for (const PostureDirections& posture : postures) tell(posture.predicted);
    return lines;
  }
  PredictedPosture worst = std::max_element(postures.begin(), postures.end(), [](const auto& a, const auto& b) {
                             return a.predicted.fit_error < b.predicted.fit_error;
                           })->predicted;
  worst.outside = false;
  tell(worst);
  const auto outside = [](const PostureDirections& posture) { return posture.predicted.outside; };
  const auto first = std::find_if(postures.begin(), postures.end(), outside);
  if (first == postures.end()) return lines;
  lines.push_back(std::to_string(std::count_if(first, postures.end(), outside)) + " of " +
                  std::to_string(postures.size()) +
                  " combinations lie outside the map and are not chosen; the first, " +
                  variation_text(first->variation) + ": " + outside_map_text(first->predicted));
  return lines;
}

}  // namespace

DirectionsResult study_directions(const Cell& cell, const Cut& cut, const std::vector<std::string>& postures,
                                  const VariationsAsked& asked, const DirectionStudy& study, int threads,
                                  const std::function<void(double)>& progress) {
  const CellDynamics dynamics = read_cell_dynamics(cell);
  const PostureMover mover(cell, dynamics.map, asked);
  const Tool& tool = require(cell, cell.tool, "tool");
  const Material& material = require(cell, cell.material, "material");
  std::vector<Posture> tasks;
  if (postures.empty()) tasks = dynamics.map.postures;
  for (const std::string& named : postures) tasks.push_back(posture_of(cell, dynamics.map, named));
  const std::vector<Variation> variations = all_variations(asked);

  std::vector<Attempt> attempts(tasks.size() * variations.size());
  std::atomic<std::size_t> done{0};
  const auto solve = [&](std::size_t i) {
    const std::size_t task = i / variations.size();
    const Variation& variation = variations[i % variations.size()];
    Posture posture;
    try {
      posture = mover.moved(tasks[task], variation);
    } catch (const std::invalid_argument& error) {
      attempts[i].refusal = tasks[task].id + ", " + variation_text(variation) + ": " + error.what();
    }
    if (attempts[i].refusal.empty()) {
      PostureDirections found{stability_posture(cell, dynamics, posture), {}, task, variation};
      const std::vector<Mode>& modes = found.predicted.posture.modes;
      found.curves = limits_over_direction(tool, material, cut, modes, study);
      if (asked.any()) {
        DirectionStudy own = study;
        own.directions = {cut.feed_direction};
        found.own_limit = absolute_limit(limits_over_direction(tool, material, cut, modes, own).front().limits);
      }
      attempts[i].found = std::move(found);
    }
    ++done;
  };
  try {
    run_tasks(attempts.size(), threads, solve,
              [&] { progress(static_cast<double>(done) / static_cast<double>(attempts.size())); });
  } catch (const std::invalid_argument& error) {
    throw InputError(cell.file.string(), 0, error.what());
  }

  DirectionsResult result{study, {}, {}, asked};
  for (const Posture& task : tasks) result.tasks.push_back(task.id);
  std::size_t left_out = 0;
  std::string reason;
  for (Attempt& attempt : attempts) {
    if (attempt.found) {
      result.postures.push_back(std::move(*attempt.found));
    } else if (left_out++ == 0) {
      reason = attempt.refusal;
    }
  }
  if (result.postures.empty()) throw InputError(asked.robot, 0, "the robot can stand in none of them; " + reason);
  result.warnings = warnings_of(tool, cut, result.postures, asked.any());
  if (left_out > 0) {
    result.warnings.push_back(std::to_string(left_out) + " of " + std::to_string(attempts.size()) +
                              " combinations are left out; the first: " + reason);
  }
  if (const std::string line = mover.disagreement(dynamics.map); !line.empty()) result.warnings.push_back(line);
  return result;
}

std::size_t best_direction(const PostureDirections& posture) {
  const auto best = std::max_element(posture.curves.begin(), posture.curves.end(),
                                     [](const DirectionCurve& a, const DirectionCurve& b) {
                                       return absolute_limit(a.limits) < absolute_limit(b.limits);
                                     });
  return static_cast<std::size_t>(best - posture.curves.begin());
}

void write_directions_csv(const DirectionsResult& result, std::ostream& out) {
  const bool varied = result.asked.any();
  out << "posture,feed_direction_deg,a_abs_mm,a_pocket_mm,pocket_rpm"
      << (varied ? ",redundancy_deg,placement_x_mm,placement_y_mm,outside_map\n" : "\n");
  for (const PostureDirections& posture : result.postures) {
    for (const DirectionCurve& curve : posture.curves) {
      const Pocket pocket = deepest_pocket(curve.limits, result.study.speeds);
      std::vector<std::string> fields{csv_text(posture.predicted.posture.id),
                                      csv_number(as_given(rad_to_deg(curve.direction))),
                                      csv_number(absolute_limit(curve.limits) * 1e3), csv_number(pocket.depth * 1e3),
                                      csv_number(as_given(rad_s_to_rpm(pocket.speed)))};
      if (varied) {
        fields.push_back(csv_number(as_given(rad_to_deg(posture.variation.redundancy))));
        fields.push_back(csv_number(as_given(1e3 * posture.variation.x)));
        fields.push_back(csv_number(as_given(1e3 * posture.variation.y)));
        fields.emplace_back(posture.predicted.outside ? "1" : "0");
      }
      write_csv_row(out, fields);
    }
  }
}

nlohmann::ordered_json directions_json(const DirectionsResult& result) {
  nlohmann::ordered_json postures = nlohmann::json::array();
  for (const PostureDirections& posture : result.postures) {
    nlohmann::ordered_json directions = nlohmann::json::array();
    for (const DirectionCurve& curve : posture.curves) {
      const Pocket pocket = deepest_pocket(curve.limits, result.study.speeds);
      directions.push_back({{"feed_direction_deg", as_given(rad_to_deg(curve.direction))},
                            {"a_abs_mm", depth_json(absolute_limit(curve.limits))},
                            {"a_pocket_mm", depth_json(pocket.depth)},
                            {"pocket_rpm", as_given(rad_s_to_rpm(pocket.speed))}});
    }
    nlohmann::ordered_json entry{{"posture", posture.predicted.posture.id}};
    if (result.asked.any()) {
      entry["redundancy_deg"] = as_given(rad_to_deg(posture.variation.redundancy));
      entry["placement_x_mm"] = as_given(1e3 * posture.variation.x);
      entry["placement_y_mm"] = as_given(1e3 * posture.variation.y);
    }
    entry["outside_map"] = posture.predicted.outside;
    entry["best_direction_deg"] = as_given(rad_to_deg(posture.curves[best_direction(posture)].direction));
    entry["directions"] = std::move(directions);
    postures.push_back(std::move(entry));
  }
  constexpr const char* kMethods[] = {"sdm", "zoa", "paper"};
  return {{"method", kMethods[static_cast<int>(result.study.method)]},
          {"max_depth_mm", as_given(result.study.max_depth * 1e3)},
          {"postures", postures}};
}

void print_directions_summary(const DirectionsResult& result, std::ostream& out) {
  const double max_depth = result.study.max_depth;
  for (const PostureDirections& posture : result.postures) {
    const auto limit = [](const DirectionCurve& curve) { return absolute_limit(curve.limits); };
    const DirectionCurve& best = posture.curves[best_direction(posture)];
    const auto worst =
        std::min_element(posture.curves.begin(), posture.curves.end(),
                         [&](const DirectionCurve& a, const DirectionCurve& b) { return limit(a) < limit(b); });
    Pocket deepest;
    double pocket_direction = 0.0;
    for (const DirectionCurve& curve : posture.curves) {
      const Pocket pocket = deepest_pocket(curve.limits, result.study.speeds);
      if (pocket.depth > deepest.depth) deepest = pocket, pocket_direction = curve.direction;
    }
    out << posture.predicted.posture.id << ": at any speed best " << degrees_text(best.direction) << " with "
        << depth_text(limit(best), max_depth) << ", worst " << degrees_text(worst->direction) << " with "
        << depth_text(limit(*worst), max_depth) << "; deepest pocket " << depth_text(deepest.depth, max_depth);
    if (deepest.depth > 0.0) {
      out << " at " << csv_number(std::round(rad_s_to_rpm(deepest.speed))) << " rpm, "
          << degrees_text(pocket_direction);
    }
    out << '\n';
  }
}

}  // namespace stillcut
