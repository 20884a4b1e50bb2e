#include "tools/plot_tuning.hpp"

#include <algorithm>
#include <cmath>

#include "drivers/files/csv.hpp"

namespace stillcut {
namespace {

plot::Line curve_line(const char* label, plot::Color color) {
  return {.x = {}, .y = {}, .color = color, .width = 1.8, .label = label};
}

plot::Scatter dots_on(const plot::Line& line) {
  return {.x = line.x, .y = line.y, .color = line.color, .size = 5.0, .label = ""};
}

plot::Scatter chosen_mark(double x, double y, const char* label) {
  return {.x = {x}, .y = {y}, .color = plot::kVermilion, .size = 13.0, .label = label, .marker = plot::Marker::diamond};
}

// Receiver operating characteristic: one point a limit.
plot::Panel roc_panel(const TuningResult& result) {
  plot::Panel panel;
  panel.title = "Detected against false alarms, a point for each limit";
  panel.y = {.label = "detected [%]", .min = 0.0, .max = 118.0};
  plot::Line line = curve_line("", plot::kBlue);
  double most = 0.0;
  for (const DetectionScore& score : result.curve) {
    line.x.push_back(score.false_alarms_per_hour());
    line.y.push_back(score.detected_percent());
    if (std::isfinite(line.x.back())) most = std::max(most, line.x.back());
  }
  // A little left of zero and beyond the last, so that points at the ends are whole.
  const double span = std::max(most, result.wished_per_hour);
  const double margin = 0.02 * (span > 0.0 ? span : 1.0);
  panel.x = plot::Axis{.label = "false alarms an hour", .min = -margin, .max = span + 3.0 * margin};
  const double x = line.x[result.choice.limit], y = line.y[result.choice.limit];
  panel.lines = {line};
  panel.points = {dots_on(line), chosen_mark(x, y, "chosen")};
  panel.notes = {{x + margin, y - 8.0, "limit " + csv_number(result.chosen_limit()), plot::kVermilion}};
  panel.events = {{result.wished_per_hour, "wished", plot::kGrey}};
  return panel;
}

plot::Panel delay_panel(const TuningResult& result) {
  plot::Panel panel;
  panel.title = "Delay after the labelled beginning";
  panel.y = {.label = "delay [ms]"};
  panel.x = plot::Axis{.label = "limit (power of a line over its floor)",
                       .min = 0.5,
                       .max = static_cast<double>(result.limits.size()) + 0.5};
  plot::Line median = curve_line("median", plot::kBlue), p95 = curve_line("95th percentile", plot::kOrange);
  for (std::size_t i = 0; i < result.limits.size(); ++i) {
    panel.x->names.push_back(csv_number(result.limits[i]));
    const double place = static_cast<double>(i + 1);  // the grid's ratios are equal: this is a logarithmic axis
    median.x.push_back(place);
    median.y.push_back(1e3 * result.curve[i].delay_median_s());
    p95.x.push_back(place);
    p95.y.push_back(1e3 * result.curve[i].delay_p95_s());
  }
  const auto place = static_cast<double>(result.choice.limit + 1);
  panel.points = {dots_on(median), dots_on(p95), chosen_mark(place, median.y[result.choice.limit], "chosen"),
                  chosen_mark(place, p95.y[result.choice.limit], "")};
  panel.lines = {std::move(median), std::move(p95)};
  return panel;
}

}  // namespace

plot::Figure tuning_figure(const TuningResult& result) {
  plot::Figure figure;
  figure.title = "Alarm limit from " + std::to_string(result.logs) + (result.logs == 1 ? " log" : " logs");
  figure.subtitle = result.cell.string();
  figure.panels = {roc_panel(result), delay_panel(result)};
  figure.height = 820;
  return figure;
}

}  // namespace stillcut
