#include <iomanip>
#include <ostream>

#include "tests/case_study/report_tables.hpp"
#include "tests/case_study/slender_map.hpp"
#include "tests/case_study/slender_study.hpp"
#include "tools/cell_posture.hpp"
#include "tools/progress.hpp"

namespace stillcut::case_study {

void print_slender(const std::filesystem::path& file, int jobs, std::ostream& out) {
  constexpr int kSpeeds = 201;
  const Cell cell = read_cell(file);
  const DynamicsMap map = read_cell_dynamics(cell).map;
  std::vector<SlenderFigures> figures;
  for (const double share : kRadialShares) {
    Progress progress("positions");
    figures.push_back(slender_figures(cell, map, share, kSpeeds, jobs, [&](double part) { progress.update(part); }));
    progress.finish();
  }
  const CommonLobes lobes = common_lobes(cell, map.postures.front().modes, kSpeeds);
  out << std::fixed << std::setprecision(2);
  out << "Position 1: all directions together are stable to " << lobes.absolute_mm << " mm at every speed, to "
      << lobes.depth_mm << " mm at " << std::setprecision(0) << lobes.speed_rpm << " rpm.\n\n"
      << "| position | x, mm | y, mm | peak G_xx/G_yy | least peak of G_f, ° | best feed at 25, 50, 75 %, ° | its "
         "a_abs, mm "
         "|\n| --- | --- | --- | --- | --- | --- | --- |\n";
  for (std::size_t p = 0; p < map.postures.size(); ++p) {
    const Posture& posture = map.postures[p];
    out << std::setprecision(0) << "| " << posture.id << " | " << posture.position[0] * 1e3 << " | "
        << posture.position[1] * 1e3 << " | " << std::setprecision(2) << peak_ratio(posture.modes) << " | "
        << std::setprecision(0) << least_peak_deg(posture.modes) << " | ";
    const char* comma = "";
    for (const SlenderFigures& f : figures) out << comma << f.best_deg[p], comma = ", ";
    out << " | " << std::setprecision(2);
    comma = "";
    for (const SlenderFigures& f : figures) out << comma << f.best_mm[p], comma = ", ";
    out << " |\n";
  }
  out << '\n';
}

}  // namespace stillcut::case_study
