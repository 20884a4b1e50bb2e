// A posture's responses and the fit over them.
#include "tools/plot_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "models/machining.hpp"

namespace stillcut {
namespace {

constexpr std::array kEntryColors{plot::kBlue, plot::kVermilion, plot::kGreen};
struct Entry {
  int response = 0, force = 0;
};

// Direct ones first, then the others.
std::vector<Entry> shown_entries(const FrequencyResponse& response) {
  std::vector<Entry> entries;
  for (const bool direct : {true, false})
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j)
        if ((i == j) == direct && !response.receptance[i][j].empty() && entries.size() < kEntryColors.size())
          entries.push_back({static_cast<int>(i), static_cast<int>(j)});
  return entries;
}

std::string name_of(const Entry& entry) { return {"xyz"[entry.response], "xyz"[entry.force]}; }

plot::Line line_of(const std::vector<double>& hz, const ComplexValues& values, bool phase) {
  plot::Line line;
  line.x = hz;
  for (const std::complex<double>& value : values)
    line.y.push_back(phase ? rad_to_deg(std::arg(value)) : 1e6 * std::abs(value));
  if (phase)  // from -180 to 180 degrees is no way that the phase goes
    for (std::size_t i = 1; i < line.y.size(); ++i)
      if (std::abs(line.y[i] - line.y[i - 1]) > 180.0) line.y[i - 1] = kNaN;
  return line;
}

// No lines where nobody measured it.
plot::Panel coherence_panel(const FittedPosture& fitted, const std::vector<Entry>& entries,
                            const std::vector<double>& hz) {
  plot::Panel panel;
  panel.title = "Coherence: how much of the motion the force explains";
  panel.y = {.label = "", .min = 0.0, .max = 1.05};
  panel.height = 0.6;
  for (std::size_t e = 0; e < entries.size(); ++e) {
    const auto& values =
        fitted.response
            .coherence[static_cast<std::size_t>(entries[e].response)][static_cast<std::size_t>(entries[e].force)];
    if (values.empty()) continue;
    plot::Line line;
    line.x = hz;
    for (const std::size_t at : fitted.fit.lines) line.y.push_back(values[at]);
    line.color = kEntryColors[e];
    line.width = 1.0;
    panel.lines.push_back(std::move(line));
  }
  return panel;
}

plot::Panel chart_panel(const StabilizationChart& chart) {
  plot::Scatter other{.x = {}, .y = {}, .color = plot::kGrey, .size = 3.0, .label = "new"};
  other.marker = plot::Marker::cross;
  plot::Scatter frequency{.x = {}, .y = {}, .color = plot::kOrange, .size = 4.0, .label = "frequency stays"};
  plot::Scatter damping{.x = {}, .y = {}, .color = plot::kSkyBlue, .size = 4.5, .label = "damping too"};
  plot::Scatter shape{.x = {}, .y = {}, .color = plot::kBlue, .size = 5.0, .label = "shape too"};
  for (const ChartRow& row : chart.rows)
    for (const ChartPole& pole : row.poles) {
      plot::Scatter& kind = !pole.stable_frequency ? other
                            : !pole.stable_damping ? frequency
                            : !pole.stable_shape   ? damping
                                                   : shape;
      kind.x.push_back(pole.natural_frequency / kTwoPi);
      kind.y.push_back(row.order);
    }
  plot::Panel panel;
  panel.title = "Stabilization chart: poles of fits of rising order, and what stays from one to the next";
  panel.y.label = "order";
  panel.points = {std::move(other), std::move(frequency), std::move(damping), std::move(shape)};
  return panel;
}

}  // namespace

plot::Figure response_figure(const FitStudy& study, std::size_t posture) {
  const FittedPosture& fitted = study.postures[posture];
  const ModalFit& fit = fitted.fit;
  std::vector<double> hz;
  for (const std::size_t line : fit.lines) hz.push_back(fitted.response.frequencies_hz[line]);
  plot::Panel magnitude, phase;
  magnitude.title = "Receptance: how far the tool moves for 1 N; measured pale, fitted dashed";
  magnitude.y = {.label = "µm/N", .logarithmic = true};
  magnitude.height = 1.4;
  phase.title = "Phase";
  phase.y = {.label = "degrees", .min = -185.0, .max = 185.0};
  const std::vector<Entry> entries = shown_entries(fitted.response);
  for (std::size_t e = 0; e < entries.size(); ++e) {
    const auto [i, j] = entries[e];
    const ComplexValues& all = fitted.response.receptance[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)];
    ComplexValues values;
    for (const std::size_t line : fit.lines) values.push_back(all[line]);
    const ComplexValues model = fitted_receptance(fit, i, j, hz);
    for (plot::Panel* panel : {&magnitude, &phase}) {
      plot::Line measured = line_of(hz, values, panel == &phase), drawn = line_of(hz, model, panel == &phase);
      measured.color = drawn.color = kEntryColors[e];
      measured.opacity = 0.45;
      measured.width = 1.0;
      drawn.dashed = true;
      drawn.width = 1.6;
      if (panel == &magnitude) measured.label = name_of(entries[e]);
      panel->lines.push_back(std::move(measured));
      panel->lines.push_back(std::move(drawn));
    }
  }
  plot::Panel coherence = coherence_panel(fitted, entries, hz);
  plot::Panel chart = chart_panel(fit.chart);
  for (std::size_t m = 0; m < fit.modes.size(); ++m) {
    const double at = fit.modes[m].mode.natural_frequency / kTwoPi;
    magnitude.events.push_back({at, std::to_string(study.tracks.number[posture][m]), plot::kGrey});
    chart.events.push_back({at, "", plot::kGrey});
  }
  plot::Figure figure;
  figure.title = "Posture " + study.map.postures[posture].id + ": responses and the modes fitted to them";
  figure.subtitle = fitted.file;
  figure.x.label = "frequency [Hz]";
  if (!hz.empty()) figure.x.min = hz.front(), figure.x.max = hz.back();
  figure.height = coherence.lines.empty() ? 1000 : 1120;
  figure.panels = {std::move(magnitude), std::move(phase)};
  if (!coherence.lines.empty()) figure.panels.push_back(std::move(coherence));
  figure.panels.push_back(std::move(chart));
  return figure;
}

}  // namespace stillcut
