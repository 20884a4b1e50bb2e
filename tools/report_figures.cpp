#include "tools/report_figures.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "drivers/files/csv.hpp"
#include "models/machining.hpp"

namespace stillcut {
namespace {

using plot::Panel, plot::Line, plot::Band, plot::Scatter;

std::string to_nearest(double value, double to) { return csv_number(std::round(value / to) * to); }

// Stretches of the timeline in which `wanted` holds; only the first has the label.
template <class Wanted>
void add_bands(const Report& report, Wanted wanted, plot::Color color, double opacity, const char* label,
               std::vector<Band>& bands) {
  bool open = false, labelled = false;
  for (const TimelinePoint& point : report.timeline) {
    const double end_s = point.begin_s + report.timeline_step_s;
    if (open && wanted(point.state)) bands.back().end = end_s;
    if (!open && wanted(point.state)) {
      bands.push_back({point.begin_s, end_s, color, opacity, labelled ? "" : label});
      labelled = true;
    }
    open = wanted(point.state);
  }
}

std::vector<Band> state_bands(const Report& report) {
  std::vector<Band> bands;
  add_bands(
      report, [](State s) { return s == State::entry || s == State::cut || s == State::exit; }, plot::kSkyBlue, 0.22,
      "tool in cut", bands);
  add_bands(
      report, [](State s) { return s == State::cannot_tell || s == State::fault; }, plot::kPurple, 0.3, "cannot tell",
      bands);
  add_bands(
      report, [](State s) { return s == State::chatter; }, plot::kVermilion, 0.45, "chatter", bands);
  return bands;
}

template <class Value>
Line line_of(const Report& report, plot::Color color, double width, Value value) {
  Line line{.x = {}, .y = {}, .color = color, .width = width, .label = ""};
  for (const TimelinePoint& point : report.timeline) {
    line.x.push_back(point.begin_s + 0.5 * report.timeline_step_s);
    line.y.push_back(value(point));
  }
  return line;
}

Panel speed_panel_of(const Report& report) {
  Panel panel;
  panel.title = "Spindle speed";
  panel.y.label = "rpm";
  plot::Area range{.x = {}, .low = {}, .high = {}, .color = plot::kBlue, .label = ""};
  double low = kNaN, high = kNaN;
  for (const TimelinePoint& point : report.timeline) {
    if (!std::isfinite(point.low_rpm)) continue;
    range.x.push_back(point.begin_s + 0.5 * report.timeline_step_s);
    range.low.push_back(point.low_rpm);
    range.high.push_back(point.high_rpm);
    low = std::fmin(low, point.low_rpm);
    high = std::fmax(high, point.high_rpm);
  }
  panel.areas.push_back(std::move(range));
  panel.lines.push_back(line_of(report, plot::kBlue, 1.6, [](const TimelinePoint& p) { return p.high_rpm; }));
  Scatter asked{.x = {},
                .y = {},
                .color = plot::kOrange,
                .size = 8.0,
                .label = "speed asked for",
                .marker = plot::Marker::diamond};
  for (const ReportEpisode& episode : report.episodes)
    for (const ReportCorrection& correction : episode.corrections) {
      if (!std::isfinite(correction.target_rpm)) continue;
      asked.x.push_back(correction.time_s);
      asked.y.push_back(correction.target_rpm);
      low = std::fmin(low, correction.target_rpm);
      high = std::fmax(high, correction.target_rpm);
    }
  if (!asked.x.empty()) panel.points.push_back(std::move(asked));
  const double room = std::max(0.15 * (high - low), 0.05 * high);
  if (std::isfinite(room)) panel.y.min = std::max(0.0, low - room), panel.y.max = high + room;
  return panel;
}

// What stands on a diagram: where it chattered, where it was sound, where a correction left it sound.
void add_cuts_on(const Report& report, int diagram, Panel& panel) {
  Scatter sound{.x = {}, .y = {}, .color = plot::kGreen, .size = 10.0, .label = "cut without chatter"};
  Scatter chatter{.x = {},
                  .y = {},
                  .color = plot::kVermilion,
                  .size = 11.0,
                  .label = "chatter began here",
                  .marker = plot::Marker::cross};
  Scatter mended{.x = {},
                 .y = {},
                 .color = plot::kBlue,
                 .size = 11.0,
                 .label = "chatter had ended here, still in the cut",
                 .marker = plot::Marker::diamond};
  const auto put = [](Scatter& points, double rpm, double mm) {
    points.x.push_back(rpm);
    points.y.push_back(mm);
  };
  for (const ReportCut& cut : report.cuts)
    if (cut.diagram == diagram && cut.episodes == 0) put(sound, cut.speed_rpm, cut.depth_mm);
  for (const ReportEpisode& episode : report.episodes) {
    if (episode.diagram != diagram) continue;
    put(chatter, episode.speed_rpm, episode.depth_mm);
    if (std::isfinite(episode.level_after)) put(mended, episode.end_speed_rpm, episode.end_depth_mm);
  }
  for (Scatter* points : {&sound, &chatter, &mended})
    if (!points->x.empty()) panel.points.push_back(*points);
}

// A waveform in which every column of the picture keeps its lowest and its highest value: it looks the same, and is
// drawn in a fraction of the time. Gaps wider than a column stay.
void thin_out(Line& line, std::size_t columns) {
  const std::size_t each = line.x.size() / columns;
  if (each < 4) return;
  Line thin = line;
  thin.x.clear();
  thin.y.clear();
  for (std::size_t begin = 0; begin < line.x.size(); begin += each) {
    const auto first = line.y.begin() + static_cast<std::ptrdiff_t>(begin);
    const auto last = line.y.begin() + static_cast<std::ptrdiff_t>(std::min(begin + each, line.y.size()));
    double low = kNaN, high = kNaN;
    for (auto y = first; y != last; ++y) low = std::fmin(low, *y), high = std::fmax(high, *y);
    thin.x.insert(thin.x.end(), 2, line.x[begin]);
    thin.y.insert(thin.y.end(), {low, high});
  }
  line = std::move(thin);
}

plot::Figure figure_of(const Report& report, int number) {
  const ReportLobes& lobes = report.lobes[static_cast<std::size_t>(number)];
  Panel panel;
  panel.title = "Stable below the line";
  panel.height = 1.0;
  add_cuts_on(report, number, panel);
  double deepest_cut = 0.0, deepest_limit = 0.0, low_rpm = report.min_rpm, high_rpm = report.max_rpm;
  for (const Scatter& points : panel.points)
    for (std::size_t i = 0; i < points.x.size(); ++i) {
      deepest_cut = std::fmax(deepest_cut, points.y[i]);
      low_rpm = std::fmin(low_rpm, points.x[i]);
      high_rpm = std::fmax(high_rpm, points.x[i]);
    }
  Line limit{.x = {}, .y = {}, .color = plot::kInk, .width = 2.0, .label = "limit depth, predicted"};
  for (std::size_t i = 0; i < static_cast<std::size_t>(lobes.diagram.point_count); ++i) {
    const LobePoint& point = lobes.diagram.points[i];
    limit.x.push_back(rad_s_to_rpm(point.speed));
    limit.y.push_back(std::isnan(point.depth_limit)      ? 0.0
                      : std::isfinite(point.depth_limit) ? 1e3 * point.depth_limit
                                                         : kNaN);
    if (std::isfinite(point.depth_limit)) deepest_limit = std::max(deepest_limit, 1e3 * point.depth_limit);
  }
  // Pockets may be far deeper than any cut; what was cut is to be seen.
  panel.y = {"axial depth [mm]", 0.0,
             1.1 * std::max(deepest_cut, std::min(deepest_limit, 2.5 * std::max(deepest_cut, 0.1)))};
  panel.lines.push_back(std::move(limit));
  plot::Figure figure;
  const bool of_cell = lobes.diagram.posture_stamp_ns == 0;
  figure.title = of_cell
                     ? "Lobes of the cell's posture" + (report.posture.empty() ? std::string{} : " " + report.posture)
                     : "Lobes of the robot's posture at " + to_nearest(lobes.time_s, 0.1) + " s";
  figure.subtitle = report.depth_from_robot ? "depths as the robot told them"
                                            : "depths as the cell file has them: nobody told others";
  figure.x = {.label = "spindle speed [rpm]", .min = low_rpm, .max = high_rpm};
  figure.height = 520;
  figure.panels = {std::move(panel)};
  return figure;
}

}  // namespace

plot::Figure timeline_figure(const Report& report) {
  Panel state;
  state.title = "Chatter indicator";
  state.y = {.label = "times the alarm limit", .min = 0.05, .logarithmic = true};
  double highest = 10.0;
  for (const TimelinePoint& point : report.timeline) highest = std::fmax(highest, point.indicator);
  state.y.max = 2.0 * highest;
  state.bands = state_bands(report);
  state.lines.push_back(line_of(report, plot::kInk, 1.2, [](const TimelinePoint& p) { return p.indicator; }));
  state.limits.push_back({1.0, "alarm limit", plot::kVermilion});
  Panel level;
  level.title = "Vibration at the tool, loudest 50 ms";
  double loudest = 0.0;
  for (const TimelinePoint& point : report.timeline) loudest = std::fmax(loudest, point.level);
  level.y = {.label = "m/s² rms", .min = 0.0, .max = loudest > 0.0 ? 1.05 * loudest : 1.0};
  level.bands = state.bands;
  for (Band& band : level.bands) band.label.clear();
  level.lines.push_back(line_of(report, plot::kInk, 1.0, [](const TimelinePoint& p) { return p.level; }));
  plot::Figure figure;
  figure.x = {.label = "time [s]", .min = 0.0, .max = std::max(report.played_s, report.timeline_step_s)};
  figure.height = 640;
  figure.panels = {std::move(state), std::move(level), speed_panel_of(report)};
  return figure;
}

plot::Figure episode_figure(const ReportEpisode& episode) {
  const ReplayTrace& trace = *episode.picture;
  plot::Figure figure = replay_figure(trace);
  figure.x.min = trace.start_s;
  figure.x.max = trace.start_s + static_cast<double>(trace.vibration.size()) / trace.sample_rate_hz;
  figure.width = 1100;
  figure.height = 860;
  for (Line& line : figure.panels.front().lines) thin_out(line, static_cast<std::size_t>(figure.width));
  return figure;
}

std::vector<plot::Figure> lobes_figures(const Report& report, std::size_t most) {
  std::vector<int> order(report.lobes.size()), weight(report.lobes.size(), 0);
  std::iota(order.begin(), order.end(), 0);
  constexpr int kChatterCounts = 4;
  for (const ReportCut& cut : report.cuts)
    if (cut.diagram >= 0) ++weight[static_cast<std::size_t>(cut.diagram)];
  for (const ReportEpisode& episode : report.episodes)
    if (episode.diagram >= 0) weight[static_cast<std::size_t>(episode.diagram)] += kChatterCounts;
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    return weight[static_cast<std::size_t>(a)] > weight[static_cast<std::size_t>(b)];
  });
  std::vector<plot::Figure> figures;
  for (const int number : order)
    if (figures.size() < most && weight[static_cast<std::size_t>(number)] > 0)
      figures.push_back(figure_of(report, number));
  return figures;
}

}  // namespace stillcut
