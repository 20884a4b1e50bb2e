#include "tools/plot_lobes.hpp"

#include <algorithm>
#include <cmath>

#include "models/machining.hpp"

namespace stillcut {

plot::Figure lobe_figure(const LobePicture& picture) {
  plot::Line limit, frequency;
  limit.color = plot::kBlue;
  limit.width = 2.0;
  limit.label = "limit depth";
  frequency.color = plot::kVermilion;
  double deepest = 0.0;
  for (std::size_t i = 0; i < picture.limits.size(); ++i) {
    const DepthLimit& at = picture.limits[i];
    const double rpm = rad_s_to_rpm(picture.speeds[i]);
    const double depth = std::isnan(at.depth) ? 0.0 : std::min(at.depth, picture.max_depth);
    limit.x.push_back(rpm);
    limit.y.push_back(depth * 1e3);
    frequency.x.push_back(rpm);
    frequency.y.push_back(at.chatter_frequency / kTwoPi);
    deepest = std::max(deepest, depth);
  }
  plot::Scatter cut;
  cut.x = {rad_s_to_rpm(picture.cut_speed)};
  cut.y = {picture.cut_depth * 1e3};
  cut.color = plot::kOrange;
  cut.size = 9.0;
  cut.label = "the cell's cut";
  const bool shown = !limit.x.empty() && cut.x[0] >= limit.x.front() && cut.x[0] <= limit.x.back();
  if (shown) deepest = std::max(deepest, picture.cut_depth);

  plot::Panel depths, frequencies;
  depths.title = "Stable below the line";
  depths.y = {"axial depth [mm]", 0.0, std::max(deepest * 1.1e3, 1e-6)};
  depths.height = 2.0;
  depths.lines = {limit};
  if (shown) depths.points = {cut};
  frequencies.title = "Chatter frequency at the limit";
  frequencies.y.label = "Hz";
  frequencies.lines = {frequency};

  plot::Figure figure;
  figure.title = picture.title;
  figure.subtitle = picture.subtitle;
  figure.x.label = "spindle speed [rpm]";
  figure.panels = {depths};
  const bool any_frequency =
      std::any_of(frequency.y.begin(), frequency.y.end(), [](double f) { return std::isfinite(f); });
  if (any_frequency) figure.panels.push_back(frequencies);
  return figure;
}

}  // namespace stillcut
