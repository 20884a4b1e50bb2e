#include <algorithm>
#include <iomanip>
#include <iterator>
#include <ostream>
#include <sstream>
#include <vector>

#include "tests/case_study/plate_study.hpp"
#include "tests/case_study/report_tables.hpp"
#include "tools/cell_posture.hpp"
#include "tools/progress.hpp"

namespace stillcut::case_study {
namespace {

constexpr int kSpeeds = 201;

std::string fixed(double value, int digits) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(digits) << value;
  return text.str();
}

std::string cell_text(const PatternFigures& row) {
  return fixed(row.min_mm, 3) + "–" + fixed(row.max_mm, 3) + ", " + fixed(row.asi_percent, 1);
}

std::string pocket_text(const PlateFigures::CommonPocket& pocket) {
  return fixed(pocket.depth_mm, 3) + " at " + fixed(pocket.speed_rpm, 0);
}

}  // namespace

void print_patterns(const std::filesystem::path& file, int jobs, std::ostream& out) {
  const Cell cell = read_cell(file);
  const DynamicsMap map = read_cell_dynamics(cell).map;
  std::vector<PlateFigures> all;
  std::vector<std::vector<double>> directions;
  for (const DirectionMethod method :
       {DirectionMethod::paper, DirectionMethod::zeroth_order, DirectionMethod::floquet}) {
    Progress progress("directions");
    directions.push_back(directions_of(method));
    all.push_back(plate_figures(plate_limits(cell, map, method, directions.back(), kSpeeds, jobs,
                                             [&](double share) { progress.update(share); })));
    progress.finish();
  }
  const auto row = [&](const std::string& name, const std::string& paper, const auto& text) {
    out << "| " << name << " | " << paper;
    for (const PlateFigures& figures : all) out << " | " << text(figures);
    out << " |\n";
  };
  out << "| min–max a_abs, mm, and ASI, % | paper | its projection | tensor, zeroth order | tensor, Floquet |\n"
         "| --- | --- | --- | --- | --- |\n";
  for (std::size_t i = 0; i < kPatterns; ++i)
    row(kPatternNames[i], cell_text(kTable1[i]), [&](const PlateFigures& f) { return cell_text(f.table[i]); });
  row("best zig, °", "45–55", [](const PlateFigures& f) { return fixed(f.best_zig_deg, 0); });
  row("best directions of the points, °", "40–55", [](const PlateFigures& f) {
    const auto [low, high] = std::minmax_element(f.best_deg.begin(), f.best_deg.end());
    return fixed(*low, 0) + "–" + fixed(*high, 0);
  });
  row("ZIG0 over ZIG90: lowest limit", "about 1.5", [](const PlateFigures& f) { return fixed(f.absolute_gain, 2); });
  row("ZIG0 over ZIG90: common pocket", "about 2", [](const PlateFigures& f) { return fixed(f.pocket_gain, 2); });
  for (std::size_t i = 0; i < kPatterns; ++i)
    row("common pocket " + std::string(kPatternNames[i]) + ", mm at rpm", i == 0 ? "0.25 at about 3600" : "",
        [&](const PlateFigures& f) { return pocket_text(f.pattern_pockets[i]); });
  out << "\nASI, %, and common pocket, mm at rpm, of zig at every angle:\n\n"
         "| ° | its projection | tensor, zeroth order | tensor, Floquet |\n| --- | --- | --- | --- |\n";
  for (const double degrees : directions.back()) {
    out << "| " << degrees;
    for (std::size_t m = 0; m < all.size(); ++m) {
      const auto at = std::find(directions[m].begin(), directions[m].end(), degrees);
      const auto i = static_cast<std::size_t>(at - directions[m].begin());
      out << " | ";
      if (at != directions[m].end())
        out << fixed(all[m].zig_asi_percent[i], 1) << ", " << pocket_text(all[m].pockets[i]);
    }
    out << " |\n";
  }
  out << '\n';
}

}  // namespace stillcut::case_study
