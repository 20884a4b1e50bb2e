#include "tools/direction_study.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <iomanip>
#include <nlohmann/json.hpp>
#include <ostream>
#include <set>
#include <stdexcept>

#include "drivers/files/csv.hpp"
#include "tools/tasks_on_threads.hpp"

namespace stillcut {
namespace {

// Values as users gave them: without the rounding of the way to SI units and back.
double as_given(double value) { return std::round(value * 1e6) / 1e6; }

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

}  // namespace

DirectionsResult study_directions(const Cell& cell, const Cut& cut, const std::vector<std::string>& postures,
                                  const DirectionStudy& study, int threads,
                                  const std::function<void(double)>& progress) {
  const CellDynamics dynamics = read_cell_dynamics(cell);
  DirectionsResult result{study, {}, {}};
  if (postures.empty()) {
    for (const Posture& posture : dynamics.map.postures)
      result.postures.push_back({stability_posture(cell, dynamics, posture.id), {}});
  }
  for (const std::string& asked : postures) result.postures.push_back({stability_posture(cell, dynamics, asked), {}});
  std::set<std::string> told;
  for (const PostureDirections& posture : result.postures) {
    for (const std::string& line : stability_warnings(require(cell, cell.tool, "tool"), cut, posture.predicted))
      if (told.insert(line).second) result.warnings.push_back(line);
  }

  const Tool& tool = require(cell, cell.tool, "tool");
  const Material& material = require(cell, cell.material, "material");
  std::atomic<std::size_t> done{0};
  const auto solve = [&](std::size_t i) {
    PostureDirections& posture = result.postures[i];
    posture.curves = limits_over_direction(tool, material, cut, posture.predicted.posture.modes, study);
    ++done;
  };
  try {
    run_tasks(result.postures.size(), threads, solve,
              [&] { progress(static_cast<double>(done) / static_cast<double>(result.postures.size())); });
  } catch (const std::invalid_argument& error) {
    throw InputError(cell.file.string(), 0, error.what());
  }
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
  out << "posture,feed_direction_deg,a_abs_mm,a_pocket_mm,pocket_rpm\n";
  for (const PostureDirections& posture : result.postures) {
    for (const DirectionCurve& curve : posture.curves) {
      const Pocket pocket = deepest_pocket(curve.limits, result.study.speeds);
      const std::vector<std::string> fields{
          csv_text(posture.predicted.posture.id), csv_number(as_given(rad_to_deg(curve.direction))),
          csv_number(absolute_limit(curve.limits) * 1e3), csv_number(pocket.depth * 1e3),
          csv_number(as_given(rad_s_to_rpm(pocket.speed)))};
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
    const DirectionCurve& best = posture.curves[best_direction(posture)];
    postures.push_back({{"posture", posture.predicted.posture.id},
                        {"outside_map", posture.predicted.outside},
                        {"best_direction_deg", as_given(rad_to_deg(best.direction))},
                        {"directions", directions}});
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
