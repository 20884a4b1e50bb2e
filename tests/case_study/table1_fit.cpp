#include "tests/case_study/table1_fit.hpp"

#include "models/machining.hpp"
#include "tests/case_study/coarse_lobes.hpp"
#include "tests/case_study/plate.hpp"

namespace stillcut::case_study {

double table1_cost(const Table1& ours) {
  double sum = 0.0;
  const auto add = [&](double got, double wanted) { sum += (got / wanted - 1.0) * (got / wanted - 1.0); };
  for (std::size_t i = 0; i < kPatterns; ++i) {
    add(ours[i].min_mm, kTable1[i].min_mm);
    add(ours[i].max_mm, kTable1[i].max_mm);
    add(ours[i].asi_percent, kTable1[i].asi_percent);
  }
  return sum;
}

PlateFigures coarse_figures(const LinearCut& cut, const std::vector<double>& speeds,
                            const std::vector<double>& directions_deg, const PocketParameters& parameters) {
  PlateLimits limits{directions_deg, speeds, {}};
  for (const PlatePoint& point : plate_points()) {
    const DirectReceptance receptance = direct_receptance(pocket_modes(parameters, point.u, point.v));
    PointLimits& here = limits.points.emplace_back();
    for (const double degrees : directions_deg)
      here.push_back(coarse_paper_limits(cut, receptance, deg_to_rad(degrees), speeds));
  }
  return plate_figures(limits);
}

}  // namespace stillcut::case_study
