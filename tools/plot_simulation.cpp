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

}  // namespace

plot::Figure simulation_figure(const std::string& title, const std::vector<MillingState>& states) {
  constexpr double kWindow = 0.09, kHighest = 2000.0;  // s, Hz
  using State = const MillingState&;
  plot::Panel depth, speed, force, motion, spectrum;
  depth.title = "Axial depth";
  depth.y.label = "mm";
  depth.height = 0.6;
  depth.lines = {line_of(states, "", plot::kInk, 1.8, [](State s) { return s.axial_depth * 1e3; })};
  force.title = "Force on the tool";
  force.y.label = "N";
  force.lines = {line_of(states, "x", plot::kBlue, 0.8, [](State s) { return s.force.x(); }),
                 line_of(states, "y", plot::kOrange, 0.8, [](State s) { return s.force.y(); })};
  motion.title = "Tool point";
  motion.y.label = "µm";
  motion.lines = {line_of(states, "x", plot::kBlue, 0.8, [](State s) { return s.displacement.x() * 1e6; }),
                  line_of(states, "y", plot::kOrange, 0.8, [](State s) { return s.displacement.y() * 1e6; })};
  speed.title = "Spindle speed";
  speed.y.label = "rpm";
  speed.height = 0.6;
  speed.lines = {line_of(states, "", plot::kBlue, 1.8, [](State s) { return rad_s_to_rpm(s.spindle_speed); })};
  spectrum.title = "Spectrogram of the acceleration, x";
  spectrum.y.label = "frequency [Hz]";
  spectrum.height = 1.4;

  plot::Figure figure;
  figure.title = title;
  figure.x.label = "time [s]";
  figure.height = 1150;
  figure.panels = {depth, force, motion};
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
