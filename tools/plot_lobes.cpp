#include "tools/plot_lobes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <utility>

#include "drivers/files/csv.hpp"
#include "dsp/numbers.hpp"
#include "models/machining.hpp"

namespace stillcut {
namespace {

constexpr std::array<plot::Color, kMostLobeCurves> kColors{plot::kBlue,   plot::kVermilion, plot::kGreen, plot::kPurple,
                                                           plot::kOrange, plot::kSkyBlue,   plot::kInk,   plot::kGrey};

std::string mm_text(double depth) { return csv_number(std::round(depth * 1e6) / 1e3) + " mm"; }

// The picture's depth axis ends a little above the deepest of what is drawn, m.
double deepest_shown(const LobeStudy& study, std::span<const MeasuredCut> cuts, bool with_cell_cut) {
  double deepest = 0.0;
  for (const LobeCurve& curve : study.curves) {
    for (const DepthLimit& limit : curve.limits) {
      if (std::isfinite(limit.depth)) deepest = std::max(deepest, limit.depth);
    }
    for (const DepthBand& band : curve.bands) {
      if (std::isfinite(band.low)) deepest = std::max(deepest, band.low);
    }
    if (with_cell_cut) deepest = std::max(deepest, curve.cut.axial_depth);
  }
  if (deepest == 0.0) deepest = study.question.settings.max_depth;
  constexpr double kMayStretch = 2.0;  // the picture for the sake of a mode coupling limit above the lobes
  double stretched = deepest;
  for (const LobeCurve& curve : study.curves) {
    if (curve.coupling.depth <= kMayStretch * deepest) stretched = std::max(stretched, curve.coupling.depth);
  }
  for (const MeasuredCut& cut : cuts) stretched = std::max(stretched, cut.at.axial_depth_mm * 1e-3);
  return stretched;
}

// Speeds where no depth is unstable, or every depth is: shaded over the panel's height, or as strips at its upper and
// lower edge where several curves share it.
void add_stretches(const LobeStudy& study, std::size_t index, plot::Panel& panel) {
  const LobeCurve& curve = study.curves[index];
  const std::vector<double>& speeds = study.question.speeds;
  const bool alone = study.curves.size() == 1;
  constexpr double kStrip = 0.018;
  const auto at = [&](std::size_t i) { return rad_s_to_rpm(speeds[i]); };
  const auto end = curve.limits.size();
  bool labelled[2] = {!alone && index > 0, !alone && index > 0};
  for (std::size_t first = 0; first < end;) {
    const double depth = curve.limits[first].depth;
    std::size_t last = first;
    const auto same = [&](double other) {
      return std::isfinite(depth) ? std::isfinite(other)
                                  : std::isnan(depth) == std::isnan(other) && !std::isfinite(other);
    };
    while (last + 1 < end && same(curve.limits[last + 1].depth)) ++last;
    if (!std::isfinite(depth)) {
      const bool stable = std::isinf(depth);
      plot::Band band;
      band.begin = first == 0 ? at(0) : 0.5 * (at(first - 1) + at(first));
      band.end = last + 1 == end ? at(last) : 0.5 * (at(last) + at(last + 1));
      band.color = !alone ? kColors.at(index) : stable ? plot::kGreen : plot::kVermilion;
      band.opacity = alone ? 0.18 : 0.7;
      if (!alone && stable) band.top = 1.0 - kStrip * static_cast<double>(index), band.bottom = band.top - kStrip;
      if (!alone && !stable) band.bottom = kStrip * static_cast<double>(index), band.top = band.bottom + kStrip;
      if (!std::exchange(labelled[stable ? 1 : 0], true)) {
        band.label = (stable ? "no limit up to " + mm_text(study.question.settings.max_depth)
                             : std::string("unstable at every depth"));
        if (!alone) band.label += stable ? " (at the top)" : " (at the bottom)";
      }
      panel.bands.push_back(band);
    }
    first = last + 1;
  }
}

void add_band(const LobeStudy& study, std::size_t index, double top, plot::Panel& panel) {
  const LobeCurve& curve = study.curves[index];
  plot::Area area;
  area.color = kColors.at(index);
  area.opacity = 0.2;
  for (std::size_t i = 0; i < curve.bands.size(); ++i) {
    area.x.push_back(rad_s_to_rpm(study.question.speeds[i]));
    area.low.push_back(std::min(curve.bands[i].low, top) * 1e3);
    area.high.push_back(std::min(curve.bands[i].high, top) * 1e3);
  }
  if (area.x.empty()) return;
  const double percent = std::round(study.question.confidence->probability * 1000.0) / 10.0;
  if (index == 0) area.label = "below: stable, above: unstable, with " + csv_number(percent) + " %";
  panel.areas.push_back(std::move(area));
}

void add_coupling(const LobeStudy& study, std::size_t index, double top, plot::Panel& panel) {
  const LobeCurve& curve = study.curves[index];
  const bool alone = study.curves.size() == 1;
  const std::string text = (alone ? "mode coupling " : curve_name(curve) + ": mode coupling ") +
                           coupling_text(curve.coupling, study.question.settings.max_depth);
  if (curve.coupling.depth <= top) {
    constexpr double kTextWidth = 0.32;
    panel.limits.push_back({.y = curve.coupling.depth * 1e3,
                            .text = text,
                            .color = alone ? plot::kPurple : kColors.at(index),
                            .text_at = kTextWidth * static_cast<double>(index % 3)});
  }
}

void add_curve(const LobeStudy& study, std::size_t index, plot::Panel& depths, plot::Panel& frequencies) {
  const LobeCurve& curve = study.curves[index];
  plot::Line limit, frequency;
  plot::Scatter lone;  // a limit between speeds without one: no line leads there
  limit.color = frequency.color = lone.color = kColors.at(index);
  limit.width = 2.0;
  limit.label = study.curves.size() == 1 ? "limit depth" : curve_name(curve);
  for (std::size_t i = 0; i < curve.limits.size(); ++i) {
    const DepthLimit& at = curve.limits[i];
    const double rpm = rad_s_to_rpm(study.question.speeds[i]), depth = std::isfinite(at.depth) ? at.depth * 1e3 : kNaN;
    limit.x.push_back(rpm);
    limit.y.push_back(depth);
    frequency.x.push_back(rpm);
    frequency.y.push_back(at.chatter_frequency / kTwoPi);
    const bool joined = (i > 0 && std::isfinite(curve.limits[i - 1].depth)) ||
                        (i + 1 < curve.limits.size() && std::isfinite(curve.limits[i + 1].depth));
    if (!joined) lone.x.push_back(rpm), lone.y.push_back(depth);
  }
  if (!lone.x.empty()) {
    depths.points.push_back(lone);
    lone.y.clear();
    for (const double rpm : lone.x) {
      lone.y.push_back(frequency.y[static_cast<std::size_t>(std::find(frequency.x.begin(), frequency.x.end(), rpm) -
                                                            frequency.x.begin())]);
    }
    frequencies.points.push_back(lone);
  }
  depths.lines.push_back(std::move(limit));
  frequencies.lines.push_back(std::move(frequency));
}

void add_cuts(std::span<const MeasuredCut> cuts, const CutLabels& labels, plot::Panel& panel) {
  const std::tuple<Verdict, const std::string&, plot::Color, plot::Marker> kinds[] = {
      {Verdict::stable, labels.stable, plot::kGreen, plot::Marker::disc},
      {Verdict::near_limit, labels.near_limit, plot::kOrange, plot::Marker::diamond},
      {Verdict::unstable, labels.unstable, plot::kVermilion, plot::Marker::cross}};
  for (const auto& [verdict, label, color, marker] : kinds) {
    plot::Scatter points;
    points.color = color;
    points.marker = marker;
    points.size = 9.0;
    points.label = label;
    for (const MeasuredCut& cut : cuts) {
      if (cut.verdict != verdict) continue;
      points.x.push_back(cut.at.spindle_speed_rpm);
      points.y.push_back(cut.at.axial_depth_mm);
    }
    if (!points.x.empty()) panel.points.push_back(std::move(points));
  }
}

std::string subtitle_of(const LobeStudy& study) {
  const LobeCurve& first = study.curves.front();
  std::string text = study.question.settings.method == LobeMethod::floquet ? "converged Floquet solution"
                                                                           : "zeroth order, a first look";
  if (study.curves.size() > 1) return text;
  const double direction = std::round(rad_to_deg(first.cut.feed_direction) * 100.0) / 100.0;
  return "feed direction " + csv_number(direction) + "°, " + text +
         "; mode coupling without regeneration: " + coupling_text(first.coupling, study.question.settings.max_depth);
}

}  // namespace

plot::Figure lobe_figure(const LobeStudy& study, std::span<const MeasuredCut> cuts, const CutLabels& labels) {
  const std::vector<double>& speeds = study.question.speeds;
  const Cut& cell_cut = study.curves.front().cut;
  const bool with_cell_cut = cell_cut.spindle_speed >= speeds.front() && cell_cut.spindle_speed <= speeds.back();
  const double top = 1.1 * std::max(deepest_shown(study, cuts, with_cell_cut), 1e-9);

  plot::Panel depths, frequencies;
  depths.title = "Stable below the line";
  depths.y = {"axial depth [mm]", 0.0, top * 1e3};
  depths.height = 2.0;
  frequencies.title = "Chatter frequency at the limit";
  frequencies.y.label = "Hz";
  for (std::size_t i = 0; i < study.curves.size(); ++i) {
    add_stretches(study, i, depths);
    add_band(study, i, top, depths);
    add_curve(study, i, depths, frequencies);
    add_coupling(study, i, top, depths);
  }
  if (with_cell_cut) {
    depths.points.push_back({.x = {rad_s_to_rpm(cell_cut.spindle_speed)},
                             .y = {cell_cut.axial_depth * 1e3},
                             .color = plot::kInk,
                             .size = 15.0,
                             .label = "the cell's cut",
                             .marker = plot::Marker::diamond});
  }
  add_cuts(cuts, labels, depths);  // on top of the cell's cut, where it was made

  plot::Figure figure;
  const std::string posture = study.curves.front().predicted.posture.id;
  figure.title = study.curves.size() > 1 ? "Stability lobes" : "Stability lobes, posture " + posture;
  figure.subtitle = subtitle_of(study);
  figure.x.label = "spindle speed [rpm]";
  if (speeds.size() > 1) figure.x.min = rad_s_to_rpm(speeds.front()), figure.x.max = rad_s_to_rpm(speeds.back());
  for (const MeasuredCut& cut : cuts) {
    figure.x.min = std::fmin(figure.x.min, cut.at.spindle_speed_rpm);
    figure.x.max = std::fmax(figure.x.max, cut.at.spindle_speed_rpm);
  }
  figure.panels = {depths};
  const bool any_frequency =
      std::any_of(frequencies.lines.begin(), frequencies.lines.end(), [](const plot::Line& line) {
        return std::any_of(line.y.begin(), line.y.end(), [](double f) { return std::isfinite(f); });
      });
  if (any_frequency) figure.panels.push_back(frequencies);
  return figure;
}

}  // namespace stillcut
