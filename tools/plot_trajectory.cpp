#include "tools/plot_trajectory.hpp"

#include <array>
#include <functional>
#include <utility>

namespace stillcut {
namespace {

constexpr std::array kMoveColors{plot::kBlue,   plot::kVermilion, plot::kGreen, plot::kOrange,
                                 plot::kPurple, plot::kSkyBlue,   plot::kInk};
constexpr int kInstants = 600;

plot::Line curve_of(const AxisTrajectory& move, plot::Color color, const std::string& label,
                    const std::function<double(const MotionState&)>& value) {
  plot::Line line{.x = {}, .y = {}, .color = color, .width = 1.8, .label = label};
  for (int i = 0; i <= kInstants; ++i) {
    const double t = move.duration() * i / kInstants;
    line.x.push_back(t);
    line.y.push_back(value(move.at(t)));
  }
  return line;
}

plot::Line jerk_steps(const AxisTrajectory& move, plot::Color color) {
  plot::Line line{.x = {0.0}, .y = {0.0}, .color = color, .width = 1.8, .label = ""};
  double time = 0.0;
  for (std::size_t i = 0; i < move.phase_count(); ++i) {
    line.x.insert(line.x.end(), {time, time + move.phase(i).duration});
    line.y.insert(line.y.end(), {move.phase(i).jerk, move.phase(i).jerk});
    time += move.phase(i).duration;
  }
  line.x.push_back(time);
  line.y.push_back(0.0);
  return line;
}

}  // namespace

plot::Figure trajectory_figure(const std::vector<DrawnMove>& moves, const std::string& subtitle) {
  plot::Figure figure;
  figure.title = "Jerk-limited moves";
  figure.subtitle = subtitle;
  figure.x.label = "time [s]";
  figure.panels.resize(4);
  constexpr std::array kTitles{"Position", "Velocity", "Acceleration", "Jerk"};
  constexpr std::array kUnits{"[unit]", "[unit/s]", "[unit/s²]", "[unit/s³]"};
  const std::array<std::function<double(const MotionState&)>, 3> values{
      [](const MotionState& s) { return s.position; }, [](const MotionState& s) { return s.velocity; },
      [](const MotionState& s) { return s.acceleration; }};
  for (std::size_t p = 0; p < figure.panels.size(); ++p) {
    plot::Panel& panel = figure.panels[p];
    panel.title = kTitles[p];
    panel.y.label = kUnits[p];
    for (std::size_t i = 0; i < moves.size(); ++i) {
      const plot::Color color = kMoveColors[i % kMoveColors.size()];
      const std::string label = p == 0 && moves.size() > 1 ? moves[i].label : "";
      panel.lines.push_back(p < values.size() ? curve_of(moves[i].trajectory, color, label, values[p])
                                              : jerk_steps(moves[i].trajectory, color));
    }
  }
  return figure;
}

}  // namespace stillcut
