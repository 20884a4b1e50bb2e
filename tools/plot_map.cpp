// The pictures of `stillcut map`.
#include <algorithm>
#include <cmath>

#include "models/machining.hpp"
#include "models/receptance_peaks.hpp"
#include "tools/map_report.hpp"

namespace stillcut {
namespace {

struct Style {
  MapMethod method = MapMethod::mean;
  plot::Color color;
  double size = 0.0, shift = 0.0;  // px; postures, so that points of one posture stand beside each other
  const char* label = "";
};
constexpr Style kStyles[] = {{MapMethod::mean, plot::kGrey, 6.0, -0.21, "mean of the others"},
                             {MapMethod::frf, plot::kOrange, 7.0, -0.07, "frf"},
                             {MapMethod::modal, plot::kSkyBlue, 7.0, 0.07, "modal"},
                             {MapMethod::trend, plot::kVermilion, 7.0, 0.21, "trend"}};

plot::Scatter scatter(const Style& style) {
  return {.x = {}, .y = {}, .color = style.color, .size = style.size, .label = style.label};
}

// The measured values as a short bar through each posture's place.
plot::Line measured_bars() { return {.x = {}, .y = {}, .color = plot::kInk, .width = 2.5, .label = "measured"}; }

void add_bar(plot::Line& line, double at, double value) {
  constexpr double kHalf = 0.34;
  const double gap = std::nan("");
  line.x.insert(line.x.end(), {at - kHalf, at + kHalf, gap});
  line.y.insert(line.y.end(), {value, value, gap});
}

plot::Line response_line(const std::vector<Mode>& modes, const std::vector<double>& frequencies) {
  plot::Line line;
  for (const double frequency : frequencies) {
    line.x.push_back(frequency / kTwoPi);
    line.y.push_back(largest_receptance(modes, frequency) * 1e6);
  }
  return line;
}

}  // namespace

plot::Figure report_figure(const LeaveOneOut& report) {
  plot::Panel frequency, peak;
  plot::Line frequency_bars = measured_bars(), peak_bars = measured_bars();
  const std::size_t count = report.postures.size();
  for (std::size_t i = 0; i < count; ++i) {
    const LeftOutPrediction& any = report.postures[i].by(MapMethod::mean);
    add_bar(frequency_bars, static_cast<double>(i + 1), any.modes.front().measured.natural_frequency / kTwoPi);
    add_bar(peak_bars, static_cast<double>(i + 1), any.measured_peak * 1e6);
  }
  for (const Style& style : kStyles) {
    if (std::find(report.methods.begin(), report.methods.end(), style.method) == report.methods.end()) continue;
    plot::Scatter frequencies = scatter(style), peaks = scatter(style);
    for (std::size_t i = 0; i < count; ++i) {
      const LeftOutPrediction& by = report.postures[i].by(style.method);
      const auto& first = by.modes.front().predicted;
      frequencies.x.push_back(static_cast<double>(i + 1) + style.shift);
      frequencies.y.push_back(first ? first->natural_frequency / kTwoPi : std::nan(""));
      peaks.x.push_back(frequencies.x.back());
      peaks.y.push_back(by.predicted_peak > 0.0 ? by.predicted_peak * 1e6 : std::nan(""));
    }
    frequency.points.push_back(std::move(frequencies));
    peak.points.push_back(std::move(peaks));
  }
  frequency.title = "Lowest mode: natural frequency";
  frequency.y.label = "Hz";
  frequency.lines = {std::move(frequency_bars)};
  peak.title = "Peak receptance: how far the tool moves at most for 1 N";
  peak.y.label = "µm/N";
  peak.lines = {std::move(peak_bars)};

  plot::Figure figure;
  figure.title = "Every posture predicted from the others";
  figure.subtitle = std::string("Points on the bars: the map can be trusted between its postures. Best here: ") +
                    name_of(report.best);
  figure.x = {.label = "posture", .min = 0.5, .max = static_cast<double>(count) + 0.5};
  for (const LeftOutPosture& posture : report.postures) figure.x.names.push_back(posture.id);
  figure.panels = {std::move(frequency), std::move(peak)};
  figure.height = 760;
  return figure;
}

plot::Figure prediction_figure(const PredictedPosture& predicted, const Posture& nearest) {
  std::vector<Mode> all = predicted.posture.modes;
  all.insert(all.end(), nearest.modes.begin(), nearest.modes.end());
  const std::vector<double> frequencies = peak_frequencies(all, 16.0);
  plot::Line measured = response_line(nearest.modes, frequencies);
  plot::Line line = response_line(predicted.posture.modes, frequencies);
  measured.color = plot::kGrey;
  measured.label = "measured at the nearest posture, " + nearest.id;
  line.color = plot::kBlue;
  line.width = 2.0;
  line.label = "predicted";
  plot::Panel panel;
  panel.title = "Largest receptance over all directions";
  panel.y = {.label = "µm/N", .logarithmic = true};
  panel.lines = {std::move(measured), std::move(line)};
  plot::Figure figure;
  figure.title = "Predicted dynamics, posture " + predicted.posture.id;
  figure.subtitle = posture_distance_text(predicted.nearest_distance, predicted.in_joints) +
                    " from the nearest measured posture" + (predicted.outside ? ": OUTSIDE the map" : "");
  figure.x.label = "frequency [Hz]";
  figure.panels = {std::move(panel)};
  figure.height = 560;
  return figure;
}

}  // namespace stillcut
