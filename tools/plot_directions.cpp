// The picture of limits over the feed direction: a polar diagram. Declared in direction_study.hpp.
#include <algorithm>
#include <array>
#include <cmath>

#include "drivers/files/csv.hpp"
#include "tools/direction_study.hpp"

namespace stillcut {
namespace {

constexpr std::array<plot::Color, 7> kTurns{plot::kBlue,   plot::kVermilion, plot::kGreen, plot::kPurple,
                                            plot::kOrange, plot::kSkyBlue,   plot::kInk};

// A limit as the picture can hold it, mm: what is stable at every depth lies on its edge.
double shown_mm(double depth, double max_depth) { return 1e3 * std::min(depth, max_depth); }

// The absolute limit in all directions, around and back to the first.
plot::Line around(const PostureDirections& posture, double max_depth) {
  plot::Line line;
  const std::size_t count = posture.curves.size();
  for (std::size_t i = 0; i <= count; ++i) {
    const DirectionCurve& curve = posture.curves[i % count];
    const double radius = shown_mm(absolute_limit(curve.limits), max_depth);
    line.x.push_back(radius * std::cos(curve.direction));
    line.y.push_back(radius * std::sin(curve.direction));
  }
  return line;
}

plot::Line circle(double radius) {
  plot::Line line;
  constexpr int kCorners = 120;
  for (int i = 0; i <= kCorners; ++i) {
    line.x.push_back(radius * std::cos(kTwoPi * i / kCorners));
    line.y.push_back(radius * std::sin(kTwoPi * i / kCorners));
  }
  line.color = plot::kGrey;
  line.width = 0.7;
  line.dashed = true;
  return line;
}

// 1, 2 or 5 times a power of ten, at most `value`.
double round_step(double value) {
  const double decade = std::pow(10.0, std::floor(std::log10(value)));
  for (const double digit : {5.0, 2.0})
    if (digit * decade <= value) return digit * decade;
  return decade;
}

}  // namespace

plot::Figure directions_figure(const DirectionsResult& result) {
  const double max_depth = result.study.max_depth;
  plot::Panel panel;
  double longest = 0.0;
  const bool named = result.postures.size() <= kTurns.size();
  plot::Scatter best;
  best.label = "best direction";
  for (std::size_t i = 0; i < result.postures.size(); ++i) {
    const PostureDirections& posture = result.postures[i];
    plot::Line line = around(posture, max_depth);
    line.color = kTurns[i % kTurns.size()];
    if (named) line.label = posture.predicted.posture.id;
    if (!named) line.opacity = 0.5, line.width = 1.0;
    for (std::size_t j = 0; j < line.x.size(); ++j) longest = std::max(longest, std::hypot(line.x[j], line.y[j]));
    const std::size_t at = best_direction(posture);
    best.x.push_back(line.x[at]);
    best.y.push_back(line.y[at]);
    panel.lines.push_back(std::move(line));
  }
  panel.points.push_back(best);
  if (longest == 0.0) longest = shown_mm(max_depth, max_depth);
  const double reach = 1.08 * longest, step = round_step(longest / 2.0);
  for (double radius = step; radius <= reach; radius += step) {
    panel.lines.push_back(circle(radius));
    panel.notes.push_back({0.0, radius, csv_number(std::round(radius * 1e4) / 1e4) + " mm", plot::kGrey});
  }
  panel.y = {"limit along Y, mm", -reach, reach};
  plot::Figure figure;
  figure.title = "Depth that is stable at every speed, over the feed direction";
  figure.subtitle = csv_number(std::round(rad_s_to_rpm(result.study.speeds.front()))) + " to " +
                    csv_number(std::round(rad_s_to_rpm(result.study.speeds.back()))) +
                    " rpm; distance from the middle is the limit, feed to the right along +X";
  figure.x = {"limit along X, mm", -reach, reach};
  figure.panels = {std::move(panel)};
  figure.width = 900;
  figure.height = 960;
  return figure;
}

}  // namespace stillcut
