// The picture of compare_runs: chatter, speed, metal removed and surface of the runs, each in its colour.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "models/surface_form.hpp"
#include "models/surface_roughness.hpp"
#include "tools/compare_runs.hpp"

namespace stillcut {
namespace {

constexpr std::array<plot::Color, 3> kRunColor{plot::kVermilion, plot::kBlue, plot::kGreen};
constexpr std::size_t kShownMs = 5;        // one point of a line
constexpr double kShownLength = 2.4e-3;    // m, three sampling lengths
constexpr double kBeforeExitWay = 1.5e-3;  // m: nothing of the exit yet
constexpr double kShownSpacing = 4e-6;     // m
constexpr double kMm3PerMinute = 1e9 * 60.0;

plot::Line run_line(const std::vector<ComparedRun>& runs, std::size_t r, double width) {
  plot::Line line{.x = {}, .y = {}, .color = kRunColor.at(r), .width = width, .label = runs[r].name};
  return line;
}

// A line a run over time, each point the largest of a few milliseconds.
template <class Value>
std::vector<plot::Line> lines_over_time(const std::vector<ComparedRun>& runs, double width, Value value) {
  std::vector<plot::Line> lines;
  for (std::size_t r = 0; r < runs.size(); ++r) {
    plot::Line line = run_line(runs, r, width);
    const VirtualMachine& machine = *runs[r].machine;
    const auto& moments = machine.moments();
    for (std::size_t i = 0; i < moments.size(); i += kShownMs) {
      double most = 0.0;
      for (std::size_t j = i; j < std::min(i + kShownMs, moments.size()); ++j) most = std::max(most, value(machine, j));
      line.x.push_back(moments[i].time);
      line.y.push_back(most);
    }
    lines.push_back(std::move(line));
  }
  return lines;
}

plot::Panel chatter_panel(const std::vector<ComparedRun>& runs) {
  plot::Panel panel;
  panel.title = "Motion of the tool point that does not repeat with the spindle: the truth of chatter";
  panel.y.label = "µm";
  panel.y.logarithmic = true;
  panel.lines = lines_over_time(runs, 1.0, [](const VirtualMachine& machine, std::size_t i) {
    const auto& ms = machine.truth().milliseconds();
    return std::max(0.1, i < ms.size() ? 1e6 * ms[i].peak : 0.0);
  });
  panel.limits = {{1e6 * ChatterTruth::kLimit, "chatter, where it does not decay", plot::kInk}};
  return panel;
}

std::string with_figures(const ComparedRun& run, const char* format, double value) {
  std::array<char, 96> text{};
  std::snprintf(text.data(), text.size(), format, value);
  return run.name + text.data();
}

plot::Panel removal_panel(const std::vector<ComparedRun>& runs) {
  plot::Panel panel;
  panel.title = "Metal removed";
  panel.y.label = "cm³ a minute";
  panel.y.min = 0.0;
  panel.lines = lines_over_time(runs, 1.8, [](const VirtualMachine& machine, std::size_t i) {
    return 1e-3 * kMm3PerMinute * machine.moments()[i].removal_rate;
  });
  for (std::size_t r = 0; r < runs.size(); ++r)
    panel.lines[r].label =
        with_figures(runs[r], ": %.1f cm³ a minute on average", 1e-3 * runs[r].score.removed_mm3_per_min.value_or(0.0));
  return panel;
}

std::string surface_name(const std::vector<ComparedRun>& runs) { return runs.front().machine->surface().name(); }

double ra_um(const ComparedRun& run) { return run.score.roughness ? 1e6 * run.score.roughness->ra : kNaN; }

plot::Panel roughness_panel(const std::vector<ComparedRun>& runs) {
  plot::Panel panel;
  panel.title = "Roughness of the " + surface_name(runs) + ", of each 0.8 mm as it was cut";
  panel.y.label = "R_a, µm";
  panel.y.min = 0.0;
  for (std::size_t r = 0; r < runs.size(); ++r) {
    plot::Line line = run_line(runs, r, 1.4);
    line.x = runs[r].surface_time;
    for (std::size_t i = 0; i < line.x.size(); ++i) {
      const auto& roughness = runs[r].score.lengths[i].roughness;
      line.y.push_back(roughness ? 1e6 * roughness->ra : kNaN);
    }
    line.label = with_figures(runs[r], ": %.2f µm on average", ra_um(runs[r]));
    panel.lines.push_back(std::move(line));
  }
  return panel;
}

// A stretch that was cut at the full depth, towards its end, less its straight line; one above the other.
plot::Panel profile_panel(const std::vector<ComparedRun>& runs) {
  plot::Panel panel;
  panel.title = "The last of the " + surface_name(runs) +
                " at full depth, as a stylus would draw it (shifted one above the other)";
  panel.y.label = "µm";
  panel.x = plot::Axis{.label = "along the feed [mm]"};
  panel.height = 1.2;
  double offset = 0.0;
  for (std::size_t r = runs.size(); r-- > 0;) {
    const auto& moments = runs[r].machine->moments();
    double way = 0.0, until = 0.0, deepest = 0.0;
    for (const MachineMoment& moment : moments) deepest = std::max(deepest, moment.axial_depth);
    for (std::size_t i = 1; i < moments.size(); ++i) {
      way += moments[i].feed_rate * (moments[i].time - moments[i - 1].time);
      if (moments[i].axial_depth >= 0.95 * deepest) until = way;
    }
    const auto count = static_cast<std::size_t>(kShownLength / kShownSpacing);
    std::vector<double> heights =
        runs[r].machine->surface().heights(until - kShownLength - kBeforeExitWay, kShownSpacing, count);
    if (!std::all_of(heights.begin(), heights.end(), [](double h) { return std::isfinite(h); })) continue;
    const ProfileRoughness roughness = profile_roughness(heights, kShownSpacing);
    plot::Line line = run_line(runs, r, 1.3);
    line.label = with_figures(runs[r], ": R_a %.2f µm here", 1e6 * roughness.ra);
    remove_form(heights, SurfaceForm::linear);
    double lowest = 0.0, highest = 0.0;
    for (std::size_t i = 0; i < count; ++i) {
      line.x.push_back(1e3 * kShownSpacing * static_cast<double>(i));
      line.y.push_back(-1e6 * heights[i]);  // material is up
      lowest = std::min(lowest, line.y.back());
      highest = std::max(highest, line.y.back());
    }
    for (double& y : line.y) y += offset - lowest;
    offset += 1.15 * (highest - lowest) + 0.5;
    panel.lines.insert(panel.lines.begin(), std::move(line));
  }
  return panel;
}

}  // namespace

plot::Figure comparison_figure(const std::string& title, const Cell& cell, const std::vector<ComparedRun>& runs) {
  plot::Figure figure;
  figure.title = title;
  figure.subtitle =
      cell.file.string() + ": the same cut not corrected, corrected, and at a depth that is sound as programmed";
  figure.x.label = "time [s]";
  plot::Panel depth, speed;
  depth.title = "Axial depth";
  depth.y.label = "mm";
  depth.height = 0.6;
  depth.lines = lines_over_time(
      runs, 1.8, [](const VirtualMachine& machine, std::size_t i) { return 1e3 * machine.moments()[i].axial_depth; });
  speed.title = "Spindle speed";
  speed.y.label = "rpm";
  speed.height = 0.6;
  speed.lines = lines_over_time(runs, 1.8, [](const VirtualMachine& machine, std::size_t i) {
    return rad_s_to_rpm(machine.moments()[i].spindle_speed);
  });
  for (plot::Panel* panel : {&depth, &speed})
    for (plot::Line& line : panel->lines) line.label.clear();
  figure.panels = {depth, chatter_panel(runs), speed, removal_panel(runs), roughness_panel(runs), profile_panel(runs)};
  figure.height = 1500;
  return figure;
}

}  // namespace stillcut
