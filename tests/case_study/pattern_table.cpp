#include "tests/case_study/pattern_table.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>

#include "dsp/numbers.hpp"
#include "models/direction_limits.hpp"
#include "models/machining.hpp"
#include "tests/case_study/plate.hpp"

namespace stillcut::case_study {
namespace {

using Choice = std::function<std::size_t(std::size_t point)>;  // the index of the direction there

PlateFigures::CommonPocket common_pocket(const PlateLimits& limits, const Choice& direction_at) {
  std::vector<double> common(limits.speeds.size(), kInfinity);
  for (std::size_t p = 0; p < limits.points.size(); ++p) {
    const std::vector<double>& here = limits.points[p][direction_at(p)];
    for (std::size_t i = 0; i < common.size(); ++i) common[i] = std::min(common[i], here[i]);
  }
  const Pocket pocket = deepest_pocket(common, limits.speeds);
  return {pocket.depth * 1e3, rad_s_to_rpm(pocket.speed)};
}

}  // namespace

PlateFigures plate_figures(const PlateLimits& limits) {
  const auto index_of = [&](double degrees) {
    const auto& all = limits.directions_deg;
    const auto at = std::find_if(all.begin(), all.end(), [&](double d) { return std::abs(d - degrees) < 1e-9; });
    if (at == all.end()) throw std::invalid_argument("case study: directions must hold 0 and 90 degrees");
    return static_cast<std::size_t>(at - all.begin());
  };
  const std::vector<PlatePoint> plate = plate_points();
  const std::size_t directions = limits.directions_deg.size(), zero = index_of(0.0), right_angle = index_of(90.0);
  std::vector<std::vector<double>> absolute(plate.size());
  std::vector<std::size_t> best(plate.size());
  PlateFigures figures;
  for (std::size_t p = 0; p < plate.size(); ++p) {
    for (const std::vector<double>& curve : limits.points[p]) absolute[p].push_back(absolute_limit(curve));
    best[p] = static_cast<std::size_t>(std::max_element(absolute[p].begin(), absolute[p].end()) - absolute[p].begin());
    figures.best_deg.push_back(limits.directions_deg[best[p]]);
  }
  const auto figures_of = [&](const Choice& direction_at) {
    PatternFigures result{kInfinity, 0.0, 0.0};
    for (std::size_t p = 0; p < plate.size(); ++p) {
      const double limit = absolute[p][direction_at(p)];
      result.min_mm = std::min(result.min_mm, limit * 1e3);
      result.max_mm = std::max(result.max_mm, limit * 1e3);
      result.asi_percent += 100.0 * limit / absolute[p][best[p]] / static_cast<double>(plate.size());
    }
    return result;
  };
  const std::array<Choice, kPatterns> patterns{
      [&](std::size_t p) { return best[p]; }, [&](std::size_t) { return zero; },
      [&](std::size_t) { return right_angle; },
      [&](std::size_t p) { return plate[p].periphery_deg == 0.0 ? zero : right_angle; }};
  for (std::size_t i = 0; i < kPatterns; ++i) {
    figures.table[i] = figures_of(patterns[i]);
    figures.pattern_pockets[i] = common_pocket(limits, patterns[i]);
  }
  for (std::size_t d = 0; d < directions; ++d) {
    const Choice zig = [d](std::size_t) { return d; };
    figures.zig_asi_percent.push_back(figures_of(zig).asi_percent);
    figures.pockets.push_back(common_pocket(limits, zig));
  }
  const auto& asi = figures.zig_asi_percent;
  figures.best_zig_deg =
      limits.directions_deg[static_cast<std::size_t>(std::max_element(asi.begin(), asi.end()) - asi.begin())];
  figures.absolute_gain = figures.table[1].min_mm / figures.table[2].min_mm;
  figures.mean_gain = figures.table[1].asi_percent / figures.table[2].asi_percent;
  figures.pocket_gain = figures.pockets[zero].depth_mm / figures.pockets[right_angle].depth_mm;
  return figures;
}

}  // namespace stillcut::case_study
