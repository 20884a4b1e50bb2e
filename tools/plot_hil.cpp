#include "tools/plot_hil.hpp"

#include <algorithm>

namespace stillcut {
namespace {

ReplayTrace trace_of(const std::string& title, const Cell& cell, const VirtualMachine& machine, const Heard& heard) {
  ReplayTrace replay;
  replay.title = title;
  replay.subtitle = cell.file.string();
  replay.sample_rate_hz = machine.sample_rate_hz();
  replay.vibration = machine.vibration();
  replay.teeth = cell.tool->teeth;
  replay.min_speed_rpm = rad_s_to_rpm(cell.spindle->min_speed);
  replay.max_speed_rpm = rad_s_to_rpm(cell.spindle->max_speed);
  replay.trace = heard.trace;
  for (const Event& event : heard.events)
    replay.events.push_back({static_cast<double>(event.stamp_ns - machine.origin_ns()) * 1e-9, event.type, event.kind,
                             event.frequency_hz, event.spindle_speed_rpm});
  return replay;
}

template <class Value>
plot::Line line_over_time(const VirtualMachine& machine, plot::Color color, double width, Value value) {
  plot::Line line{.x = {}, .y = {}, .color = color, .width = width, .label = ""};
  const auto& moments = machine.moments();
  for (std::size_t i = 0; i < moments.size(); ++i) {
    line.x.push_back(moments[i].time);
    line.y.push_back(value(i));
  }
  return line;
}

}  // namespace

plot::Figure hil_figure(const std::string& title, const Cell& cell, const VirtualMachine& machine, const Heard& heard,
                        const HilScore& score) {
  plot::Figure figure = replay_figure(trace_of(title, cell, machine, heard));
  plot::Panel depth, truth;
  depth.title = "Axial depth";
  depth.y.label = std::string("mm");
  depth.height = 0.5;
  depth.lines = {
      line_over_time(machine, plot::kInk, 1.8, [&](std::size_t i) { return 1e3 * machine.moments()[i].axial_depth; })};
  truth.title = "Motion of the tool point that does not repeat with the spindle: the truth";
  truth.y.label = "µm";
  truth.y.logarithmic = true;
  truth.height = 0.9;
  const auto& truth_ms = machine.truth().milliseconds();
  truth.lines = {line_over_time(machine, plot::kInk, 0.8, [&](std::size_t i) {
    return std::max(0.1, i < truth_ms.size() ? 1e6 * truth_ms[i].peak : 0.0);
  })};
  truth.limits = {{1e6 * ChatterTruth::kLimit, "chatter, where it does not decay"}};
  for (const ChatterSpell& spell : score.spells)
    truth.bands.push_back(
        {spell.start, spell.end, plot::kVermilion, 0.2, &spell == score.spells.data() ? "true chatter" : ""});
  figure.panels.insert(figure.panels.begin(), depth);
  figure.panels.insert(figure.panels.end() - 2, truth);
  figure.height = 1380;
  return figure;
}

}  // namespace stillcut
