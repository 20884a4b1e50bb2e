#include <algorithm>
#include <atomic>
#include <cmath>
#include <ostream>
#include <string>
#include <vector>

#include "tests/case_study/cut_verdicts.hpp"
#include "tests/case_study/plate.hpp"
#include "tests/case_study/report_tables.hpp"
#include "tools/cell_posture.hpp"
#include "tools/progress.hpp"
#include "tools/tasks_on_threads.hpp"

namespace stillcut::case_study {
namespace {

constexpr std::array<Judge, 3> kJudges{Judge::paper_lobes, Judge::floquet, Judge::time};

std::string verdict_text(const CutVerdict& verdict) {
  if (verdict.marginal) return verdict.chatters ? "marginal (chatter)" : "marginal (stable)";
  return verdict.chatters ? "chatter" : "stable";
}

// "31/49, centre stable; chatter 502-509 Hz": agreement, the middle's verdict, quartiles of the chatter frequency.
std::string summary(const CutOfTable2& cut, const std::vector<CutVerdict>& points) {
  std::vector<double> chatter_hz;
  std::size_t agree = 0;
  for (const CutVerdict& point : points) {
    agree += agrees(cut.verdict, point) ? 1 : 0;
    if (std::isfinite(point.chatter_hz)) chatter_hz.push_back(point.chatter_hz);
  }
  std::string text = std::to_string(agree) + "; " + verdict_text(points[kCentre]);
  if (chatter_hz.empty()) return text;
  std::sort(chatter_hz.begin(), chatter_hz.end());
  const auto at = [&](double share) {
    return std::to_string(
        std::lround(chatter_hz[static_cast<std::size_t>(share * static_cast<double>(chatter_hz.size() - 1))]));
  };
  return text + "; " + at(0.25) + "–" + at(0.75);
}

}  // namespace

void print_cuts(const std::filesystem::path& file, int jobs, std::ostream& out) {
  const Cell cell = read_cell(file);
  const DynamicsMap map = read_cell_dynamics(cell).map;
  const std::size_t points = map.postures.size(), tasks = kTable2.size() * kJudges.size() * points;
  std::vector<CutVerdict> verdicts(tasks);
  std::atomic<std::size_t> done{0};
  Progress progress("cuts");
  const auto judge = [&](std::size_t task) {
    const std::size_t point = task % points, which = task / points;
    verdicts[task] =
        judge_cut(cell, map.postures[point].modes, kTable2[which / kJudges.size()], kJudges[which % kJudges.size()]);
    ++done;
  };
  run_tasks(tasks, jobs, judge, [&] { progress.update(static_cast<double>(done) / static_cast<double>(tasks)); });
  progress.finish();
  constexpr const char* kPrinted[] = {"stable", "marginal", "chatter"};
  out << "Points of 49 that agree; the plate's middle; quartiles of the chatter frequency, Hz.\n\n"
         "| cut | feed, ° | depth, mm | rpm | paper | lobes, its projection | Floquet, tensor | in time |\n"
         "| --- | --- | --- | --- | --- | --- | --- | --- |\n";
  for (std::size_t c = 0; c < kTable2.size(); ++c) {
    const CutOfTable2& cut = kTable2[c];
    out << "| " << c + 1 << " | " << cut.feed_direction_deg << " | " << cut.depth_mm << " | " << cut.speed_rpm << " | "
        << kPrinted[static_cast<int>(cut.verdict)];
    for (std::size_t j = 0; j < kJudges.size(); ++j) {
      const auto first = verdicts.begin() + static_cast<std::ptrdiff_t>((c * kJudges.size() + j) * points);
      out << " | " << summary(cut, {first, first + static_cast<std::ptrdiff_t>(points)});
    }
    out << " |\n";
  }
  out << '\n';
}

}  // namespace stillcut::case_study
