#include "tools/plot_simulation.hpp"

#include "tools/spectrogram.hpp"

namespace stillcut {
namespace {

template <class Value>
plot::Line line_of(const std::vector<MillingState>& states, const char* label, plot::Color color, double width,
                   Value value) {
  plot::Line line{.x = {}, .y = {}, .color = color, .width = width, .label = label};
  for (const MillingState& state : states) {
    line.x.push_back(state.time);
    line.y.push_back(value(state));
  }
  return line;
}

plot::Panel panel_of(const char* title, const char* unit, double height, std::vector<plot::Line> lines) {
  plot::Panel panel;
  panel.title = title;
  panel.y.label = unit;
  panel.height = height;
  panel.lines = std::move(lines);
  return panel;
}

}  // namespace

plot::Figure simulation_figure(const std::string& title, const std::vector<MillingState>& states) {
  constexpr double kWindow = 0.09, kHighest = 2000.0;  // s, Hz
  using State = const MillingState&;
  const plot::Panel depth = panel_of(
      "Axial depth", "mm", 0.6, {line_of(states, "", plot::kInk, 1.8, [](State s) { return s.axial_depth * 1e3; })});
  const plot::Panel force = panel_of("Force on the tool", "N", 1.0,
                                     {line_of(states, "x", plot::kBlue, 0.8, [](State s) { return s.force.x(); }),
                                      line_of(states, "y", plot::kOrange, 0.8, [](State s) { return s.force.y(); })});
  const plot::Panel chip = panel_of("Thickest chip", "µm", 0.6,
                                    {line_of(states, "", plot::kInk, 0.8, [](State s) { return s.chip * 1e6; })});
  const plot::Panel motion =
      panel_of("Tool point", "µm", 1.0,
               {line_of(states, "x", plot::kBlue, 0.8, [](State s) { return s.displacement.x() * 1e6; }),
                line_of(states, "y", plot::kOrange, 0.8, [](State s) { return s.displacement.y() * 1e6; })});
  const plot::Panel speed =
      panel_of("Spindle speed", "rpm", 0.6,
               {line_of(states, "", plot::kBlue, 1.8, [](State s) { return rad_s_to_rpm(s.spindle_speed); })});
  plot::Panel spectrum = panel_of("Spectrogram of the acceleration, x", "frequency [Hz]", 1.4, {});

  plot::Figure figure;
  figure.title = title;
  figure.x.label = "time [s]";
  figure.height = 1250;
  figure.panels = {depth, force, chip, motion};
  if (states.size() > 1) {
    std::vector<float> acceleration;
    acceleration.reserve(states.size());
    for (State state : states) acceleration.push_back(static_cast<float>(state.acceleration.x()));
    const double rate_hz = static_cast<double>(states.size() - 1) / (states.back().time - states.front().time);
    spectrum.image = spectrogram(acceleration, rate_hz, states.front().time, kWindow, kHighest);
    if (spectrum.image->columns > 0) figure.panels.push_back(spectrum);
  }
  figure.panels.push_back(speed);
  return figure;
}

}  // namespace stillcut
