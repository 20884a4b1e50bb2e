#include "tests/case_study/plate_study.hpp"

#include <atomic>

#include "models/lobes.hpp"
#include "tools/tasks_on_threads.hpp"

namespace stillcut::case_study {

std::vector<double> directions_of(DirectionMethod method, double step_deg) {
  const double end = method == DirectionMethod::paper ? 90.0 + 0.5 * step_deg : 180.0 - 0.5 * step_deg;
  std::vector<double> directions;
  for (int i = 0; i * step_deg < end; ++i) directions.push_back(i * step_deg);
  return directions;
}

PlateLimits plate_limits(const Cell& cell, const DynamicsMap& map, DirectionMethod method,
                         const std::vector<double>& directions_deg, int speeds, int jobs,
                         const std::function<void(double)>& progress) {
  const Tool& tool = require(cell, cell.tool, "tool");
  const Material& material = require(cell, cell.material, "material");
  const Cut& cut = require(cell, cell.cut, "cut");
  const SpindleLimits& spindle = require(cell, cell.spindle, "spindle");
  DirectionStudy study;
  for (const double degrees : directions_deg) study.directions.push_back(deg_to_rad(degrees));
  study.speeds = equally_spaced_speeds(spindle.min_speed, spindle.max_speed, speeds);
  study.method = method;
  PlateLimits limits{directions_deg, study.speeds, std::vector<PointLimits>(map.postures.size())};
  std::atomic<std::size_t> done{0};
  const auto solve = [&](std::size_t p) {
    for (DirectionCurve& curve : limits_over_direction(tool, material, cut, map.postures[p].modes, study))
      limits.points[p].push_back(std::move(curve.limits));
    ++done;
  };
  run_tasks(map.postures.size(), jobs, solve,
            [&] { progress(static_cast<double>(done) / static_cast<double>(map.postures.size())); });
  return limits;
}

}  // namespace stillcut::case_study
