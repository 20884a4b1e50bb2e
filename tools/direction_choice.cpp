#include "tools/direction_choice.hpp"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <nlohmann/json.hpp>
#include <sstream>

#include "drivers/files/csv.hpp"
#include "tools/as_given.hpp"

namespace stillcut {
namespace {

std::string choice_number(double value) { return csv_number(as_given(value)); }

std::string turn_text(double angle) { return choice_number(rad_to_deg(angle)) + "°"; }

std::string limit_text(double depth, double max_depth) {
  std::ostringstream text;
  text << std::setprecision(3) << (std::isinf(depth) ? "over " : "") << 1e3 * std::min(depth, max_depth) << " mm";
  return text.str();
}

// " (+12 %)"; empty where there is no such share.
std::string gain_text(double depth, double from) {
  if (!(from > 0.0) || !std::isfinite(from) || !std::isfinite(depth)) return "";
  std::ostringstream text;
  text << std::showpos << std::setprecision(3) << " (" << 100.0 * (depth / from - 1.0) << " %)";
  return text.str();
}

nlohmann::ordered_json a_abs_json(double depth) {
  if (std::isfinite(depth)) return as_given(1e3 * depth);
  return csv_number(depth);
}

nlohmann::ordered_json combination_json(const DirectionsResult& result, const PostureDirections* posture,
                                        double (*limit)(const PostureDirections&)) {
  if (posture == nullptr) return nullptr;
  const auto at = std::find_if(posture->curves.begin(), posture->curves.end(), [&](const DirectionCurve& curve) {
    return absolute_limit(curve.limits) == limit(*posture);
  });
  return {{"posture", result.tasks[posture->task]},
          {"redundancy_deg", as_given(rad_to_deg(posture->variation.redundancy))},
          {"placement_x_mm", as_given(1e3 * posture->variation.x)},
          {"placement_y_mm", as_given(1e3 * posture->variation.y)},
          {"feed_direction_deg", as_given(rad_to_deg(at->direction))},
          {"a_abs_mm", a_abs_json(limit(*posture))}};
}

// The combination inside the map with the highest of such limits, of equal ones the first.
const PostureDirections* highest(const DirectionsResult& result, double (*limit)(const PostureDirections&)) {
  const PostureDirections* best = nullptr;
  for (const PostureDirections& posture : result.postures) {
    if (!posture.predicted.outside && (best == nullptr || limit(posture) > limit(*best))) best = &posture;
  }
  return best;
}

}  // namespace

double best_limit(const PostureDirections& posture) {
  return absolute_limit(posture.curves[best_direction(posture)].limits);
}

double worst_limit(const PostureDirections& posture) {
  double lowest = kInfinity;
  for (const DirectionCurve& curve : posture.curves) lowest = std::min(lowest, absolute_limit(curve.limits));
  return lowest;
}

const PostureDirections* variation_at(const DirectionsResult& result, std::size_t task, const Variation& variation) {
  for (const PostureDirections& posture : result.postures) {
    if (posture.task == task && posture.variation == variation) return &posture;
  }
  return nullptr;
}

const PostureDirections* best_at(const DirectionsResult& result, std::size_t task, double x, double y) {
  const PostureDirections* best = nullptr;
  const auto rank = [](const PostureDirections& posture) {
    return std::pair{best_limit(posture), -std::abs(posture.variation.redundancy)};
  };
  for (const PostureDirections& posture : result.postures) {
    const bool here = posture.task == task && posture.variation.x == x && posture.variation.y == y;
    if (here && !posture.predicted.outside && (best == nullptr || rank(posture) > rank(*best))) best = &posture;
  }
  return best;
}

std::vector<PlacementLimit> placement_limits(const DirectionsResult& result) {
  VariationsAsked placements = result.asked;
  placements.redundancies.reset();
  std::vector<PlacementLimit> limits;
  for (const Variation& at : all_variations(placements)) {
    PlacementLimit found{at.x, at.y, kInfinity, 0};
    for (std::size_t task = 0; task < result.tasks.size(); ++task) {
      const PostureDirections* best = best_at(result, task, at.x, at.y);
      const double limit = best == nullptr ? kNaN : best_limit(*best);
      if (std::isnan(limit) || limit < found.limit) found.limit = limit, found.weakest = task;
      if (std::isnan(limit)) break;
    }
    limits.push_back(found);
  }
  return limits;
}

const PlacementLimit* best_placement(const std::vector<PlacementLimit>& placements) {
  const PlacementLimit* best = nullptr;
  const auto rank = [](const PlacementLimit& at) { return std::pair{at.limit, -std::hypot(at.x, at.y)}; };
  for (const PlacementLimit& at : placements) {
    if (!std::isnan(at.limit) && (best == nullptr || rank(at) > rank(*best))) best = &at;
  }
  return best;
}

nlohmann::ordered_json choice_json(const DirectionsResult& result) {
  nlohmann::ordered_json json{
      {"best", combination_json(result, highest(result, best_limit), best_limit)},
      {"best_worst_direction", combination_json(result, highest(result, worst_limit), worst_limit)},
      {"best_placement", nullptr}};
  const std::vector<PlacementLimit> placements = placement_limits(result);
  if (const PlacementLimit* best = best_placement(placements); best != nullptr) {
    json["best_placement"] = {{"placement_x_mm", as_given(1e3 * best->x)},
                              {"placement_y_mm", as_given(1e3 * best->y)},
                              {"a_abs_mm", a_abs_json(best->limit)},
                              {"weakest_posture", result.tasks[best->weakest]}};
  }
  return json;
}

void print_choice(const DirectionsResult& result, std::ostream& out) {
  const double max_depth = result.study.max_depth;
  const std::vector<PlacementLimit> placements = placement_limits(result);
  const PlacementLimit* placed = best_placement(placements);
  if (result.asked.xs && placed == nullptr) {
    out << "at no placement can the robot stand at every posture inside the map\n";
    return;
  }
  if (result.asked.xs) {
    out << "best placement: part moved by " << choice_number(1e3 * placed->x) << ", " << choice_number(1e3 * placed->y)
        << " mm: every posture takes at least " << limit_text(placed->limit, max_depth)
        << " in its best direction (least: " << result.tasks[placed->weakest] << ")";
    const auto here = std::find_if(placements.begin(), placements.end(),
                                   [](const PlacementLimit& at) { return at.x == 0.0 && at.y == 0.0; });
    if (here != placements.end() && !std::isnan(here->limit))
      out << "; where it is " << limit_text(here->limit, max_depth) << gain_text(placed->limit, here->limit);
    out << '\n';
  }
  const double x = placed == nullptr ? 0.0 : placed->x, y = placed == nullptr ? 0.0 : placed->y;
  for (std::size_t task = 0; task < result.tasks.size(); ++task) {
    const PostureDirections* best = best_at(result, task, x, y);
    out << result.tasks[task] << ": ";
    if (best == nullptr) {
      out << "nothing inside the map\n";
      continue;
    }
    const double limit = best_limit(*best);
    if (result.asked.redundancies) out << "best redundancy " << turn_text(best->variation.redundancy) << ", ";
    out << "feed " << turn_text(best->curves[best_direction(*best)].direction) << " with "
        << limit_text(limit, max_depth) << ", worst direction " << limit_text(worst_limit(*best), max_depth);
    const PostureDirections* plain = variation_at(result, task, {0.0, x, y});
    if (result.asked.redundancies && plain != nullptr && !plain->predicted.outside)
      out << "; redundancy 0° " << limit_text(best_limit(*plain), max_depth) << gain_text(limit, best_limit(*plain));
    out << '\n';
  }
}

}  // namespace stillcut
