#include <algorithm>
#include <limits>

#include "drivers/files/cell.hpp"
#include "tests/case_study/plate_study.hpp"
#include "tests/case_study/report_tables.hpp"
#include "tools/cell_posture.hpp"
#include "tools/plot.hpp"
#include "tools/progress.hpp"

namespace stillcut::case_study {
namespace {

constexpr double kTop_mm = 1.0;

plot::Panel panel_of(const PlateLimits& limits, std::size_t direction, const std::string& title) {
  plot::Panel panel;
  panel.title = title;
  panel.y = {.label = "depth, mm", .min = 0.0, .max = kTop_mm};
  std::vector<double> rpm, common(limits.speeds.size(), kTop_mm);
  for (const double speed : limits.speeds) rpm.push_back(rad_s_to_rpm(speed));
  for (const PointLimits& point : limits.points) {
    plot::Line line{.x = rpm, .y = {}, .color = plot::kSkyBlue, .width = 0.8, .opacity = 0.5, .label = {}};
    for (std::size_t i = 0; i < common.size(); ++i) {
      line.y.push_back(std::min(point[direction][i] * 1e3, kTop_mm));
      common[i] = std::min(common[i], line.y.back());
    }
    panel.lines.push_back(std::move(line));
  }
  panel.lines.front().label = "each of the 49 points";
  panel.lines.push_back({.x = rpm, .y = common, .color = plot::kBlue, .width = 2.0, .label = "stable at all of them"});
  plot::Scatter sound{.x = {}, .y = {}, .color = plot::kGreen, .size = 8.0, .label = "stable in the paper"};
  plot::Scatter marginal{
      .x = {}, .y = {}, .color = plot::kOrange, .size = 9.0, .label = "marginal", .marker = plot::Marker::diamond};
  plot::Scatter chatter{
      .x = {}, .y = {}, .color = plot::kVermilion, .size = 9.0, .label = "chatter", .marker = plot::Marker::cross};
  for (const CutOfTable2& cut : kTable2) {
    if (cut.feed_direction_deg != limits.directions_deg[direction]) continue;
    plot::Scatter& points = cut.verdict == Verdict::stable     ? sound
                            : cut.verdict == Verdict::unstable ? chatter
                                                               : marginal;
    points.x.push_back(cut.speed_rpm);
    points.y.push_back(cut.depth_mm);
  }
  for (plot::Scatter* points : {&sound, &marginal, &chatter})
    if (!points->x.empty()) panel.points.push_back(*points);
  return panel;
}

}  // namespace

void draw_lobes(const std::filesystem::path& file, int jobs, const std::filesystem::path& picture) {
  constexpr int kSpeeds = 201;
  const Cell cell = read_cell(file);
  const DynamicsMap map = read_cell_dynamics(cell).map;
  plot::Figure figure{.title = "Lobes of the reconstructed map at its 49 points",
                      .subtitle = "and the paper's seven cuts",
                      .x = {.label = "spindle speed, rpm",
                            .min = rad_s_to_rpm(cell.spindle->min_speed),
                            .max = rad_s_to_rpm(cell.spindle->max_speed)},
                      .panels = {},
                      .width = 1000,
                      .height = 1100};
  for (const DirectionMethod method : {DirectionMethod::paper, DirectionMethod::floquet}) {
    Progress progress("lobes");
    const PlateLimits limits =
        plate_limits(cell, map, method, {0, 90}, kSpeeds, jobs, [&](double share) { progress.update(share); });
    progress.finish();
    const std::string how = method == DirectionMethod::paper ? "paper's projection, zeroth order" : "tensor, Floquet";
    figure.panels.push_back(panel_of(limits, 0, "ZIG0: " + how));
    figure.panels.push_back(panel_of(limits, 1, "ZIG90: " + how));
  }
  plot::write_figure(figure, picture);
}

}  // namespace stillcut::case_study
