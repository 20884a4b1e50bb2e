#include "tests/case_study/slender_study.hpp"

#include <algorithm>

#include "dsp/numbers.hpp"
#include "models/lobes.hpp"

namespace stillcut::case_study {

SlenderFigures slender_figures(const Cell& cell, const DynamicsMap& map, double radial_share, int speeds, int jobs,
                               const std::function<void(double)>& progress) {
  Cell turned = cell;
  turned.cut->radial_depth = radial_share * cell.tool->diameter;
  const PlateLimits limits =
      plate_limits(turned, map, DirectionMethod::paper, directions_of(DirectionMethod::paper), speeds, jobs, progress);
  SlenderFigures figures;
  for (const PointLimits& point : limits.points) {
    std::vector<double> absolute;
    for (const std::vector<double>& curve : point) absolute.push_back(absolute_limit(curve));
    const auto best = std::max_element(absolute.begin(), absolute.end());
    figures.best_deg.push_back(limits.directions_deg[static_cast<std::size_t>(best - absolute.begin())]);
    figures.best_mm.push_back(*best * 1e3);
  }
  return figures;
}

CommonLobes common_lobes(const Cell& cell, std::span<const Mode> modes, int speeds) {
  DynamicsMap map;
  map.postures.emplace_back().modes.assign(modes.begin(), modes.end());
  const PlateLimits limits = plate_limits(cell, map, DirectionMethod::paper,
                                          directions_of(DirectionMethod::paper, 18.0), speeds, 1, [](double) {});
  std::vector<double> common(limits.speeds.size(), kInfinity);
  for (const std::vector<double>& curve : limits.points.front())
    for (std::size_t i = 0; i < common.size(); ++i) common[i] = std::min(common[i], curve[i]);
  const Pocket pocket = deepest_pocket(common, limits.speeds);
  return {absolute_limit(common) * 1e3, pocket.depth * 1e3, rad_s_to_rpm(pocket.speed)};
}

}  // namespace stillcut::case_study
