#include "tools/plot_surface_study.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "models/cutter_motion.hpp"
#include "tools/plot_surface.hpp"

namespace stillcut {
namespace {

constexpr int kStudyWidth = 1000;
constexpr double kMapRoom = 600.0, kProfileRoom = 130.0, kSpectrumRoom = 170.0, kAround = 76.0;  // px, about

struct Surface {
  const HeightMap* map;
  std::string name;
  plot::Color along, across;
};

// With its figures over it, which height_map_figure has as the subtitle: there may be two maps in the picture.
plot::Panel map_panel(const Surface& surface) {
  plot::Figure figure = height_map_figure(*surface.map, "");
  plot::Panel panel = std::move(figure.panels.front());
  panel.title = surface.name + ":  " + figure.subtitle;
  panel.x = plot::Axis{.label = "along the feed [mm]"};
  const double shape = static_cast<double>(surface.map->across) * surface.map->spacing_across /
                       (static_cast<double>(surface.map->along) * surface.map->spacing_along);
  panel.height = std::clamp(shape * (kStudyWidth - 190.0), 60.0, kMapRoom);
  return panel;
}

// The same colour is the same height.
void share_scale(plot::Image& a, plot::Image& b) {
  a.low = b.low = std::min(a.low, b.low);
  a.high = b.high = std::max(a.high, b.high);
}

// Adds what the other surface's panel has: its lines in their own colours, named.
void lay_over(plot::Panel& panel, plot::Panel other, const Surface& first, const Surface& second, bool along) {
  panel.lines.front().label = first.name;
  plot::Line line = std::move(other.lines.front());
  line.label = second.name;
  line.color = along ? second.along : second.across;
  panel.lines.push_back(std::move(line));
  if (panel.x && other.x && std::isfinite(panel.x->max) && std::isfinite(other.x->max))
    panel.x->max = std::max(panel.x->max, other.x->max);
  if (std::isfinite(panel.y.min) && std::isfinite(other.y.min)) panel.y.min = std::min(panel.y.min, other.y.min);
  for (plot::EventMark& event : panel.events) event.color = along ? first.along : first.across;
  for (plot::EventMark& event : other.events) {
    event.color = along ? second.along : second.across;
    panel.events.push_back(std::move(event));
  }
}

// Too few points for a spectrum are no reason to draw nothing.
std::vector<plot::Panel> spectrum_panels(const HeightMap& map) {
  try {
    return surface_spectrum_figure(map, "").panels;
  } catch (const std::invalid_argument&) {
    return {};
  }
}

}  // namespace

std::string surface_title(const StudiedSurface& study) {
  std::array<char, 240> text{};
  const auto written = static_cast<std::size_t>(
      std::max(0, std::snprintf(text.data(), text.size(), "%s%s%g mm %s, ", study.material.c_str(),
                                study.material.empty() ? "" : ": ", 1e3 * study.tool.diameter,
                                study.tool.shape == ToolShape::ball ? "ball end" : "end mill")));
  const std::string tool(text.data(), std::min(written, text.size() - 1));
  if (!study.question.path.empty()) return tool + "along " + study.question.path.filename().string();
  std::snprintf(text.data(), text.size(), "%.0f rpm, feed %.3g mm a tooth, step-over %.3g mm",
                rad_s_to_rpm(study.cut.spindle_speed), 1e3 * study.cut.feed_per_tooth, 1e3 * step_over_of(study.cut));
  return tool + text.data();
}

plot::Figure surface_study_figure(const StudiedSurface& study, const MeasuredSurface* measured) {
  std::vector<Surface> surfaces{{&study.map, "predicted", plot::kBlue, plot::kVermilion}};
  if (measured != nullptr)
    surfaces.push_back({&measured->map, "measured: " + measured->file, plot::kOrange, plot::kGreen});
  plot::Figure figure;
  figure.title = surface_title(study);
  figure.width = kStudyWidth;
  for (const Surface& surface : surfaces) figure.panels.push_back(map_panel(surface));
  if (surfaces.size() == 2) share_scale(*figure.panels[0].image, *figure.panels[1].image);
  const auto add = [&](auto panels_of, double room) {
    std::vector<plot::Panel> panels = panels_of(study.map);
    std::vector<plot::Panel> others = surfaces.size() == 2 ? panels_of(measured->map) : std::vector<plot::Panel>();
    for (std::size_t i = 0; i < panels.size(); ++i) {
      if (i < others.size()) lay_over(panels[i], std::move(others[i]), surfaces[0], surfaces[1], i == 0);
      panels[i].height = room;
      figure.panels.push_back(std::move(panels[i]));
    }
  };
  add([](const HeightMap& map) { return surface_profiles_figure(map, "").panels; }, kProfileRoom);
  add([](const HeightMap& map) { return spectrum_panels(map); }, kSpectrumRoom);
  double height = 60.0;
  for (const plot::Panel& panel : figure.panels) height += panel.height + kAround;
  figure.height = static_cast<int>(height);
  return figure;
}

}  // namespace stillcut
