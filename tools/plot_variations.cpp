// The picture of limits over the redundancy angle and over where the part lies. Declared in direction_choice.hpp.
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "drivers/files/csv.hpp"
#include "tools/direction_choice.hpp"

namespace stillcut {
namespace {

constexpr std::array<plot::Color, 9> kTaskColors{plot::kBlue,   plot::kVermilion, plot::kGreen,
                                                 plot::kPurple, plot::kOrange,    plot::kSkyBlue,
                                                 plot::kInk,    plot::kGrey,      plot::kYellow};
constexpr int kCellPixels = 16;  // of a grid cell, so that it is seen as one

std::string shift_text(double length) { return csv_number(std::round(length * 1e6) / 1e3); }

struct Sweep {  // one of a variation's numbers on the x axis, the others held
  std::string label, elsewhere;
  double Variation::*number = nullptr;
  double scale = 1e3;  // from SI to what is shown
  std::vector<double> values;
  Variation held;
};

// The turn at the best placement, else the part's way along the axis that was asked with several values.
std::optional<Sweep> sweep_of(const DirectionsResult& result) {
  const VariationsAsked& asked = result.asked;
  Variation held;
  if (asked.redundancies && asked.redundancies->size() > 1) {
    const std::vector<PlacementLimit> placements = placement_limits(result);
    const PlacementLimit* best = best_placement(placements);
    held.x = best == nullptr ? placements.front().x : best->x;
    held.y = best == nullptr ? placements.front().y : best->y;
    const std::string moved = "; part moved by " + shift_text(held.x) + ", " + shift_text(held.y) + " mm";
    return Sweep{"redundancy angle, °", asked.xs ? moved : "", &Variation::redundancy,
                 rad_to_deg(1.0),       *asked.redundancies,   held};
  }
  if (asked.redundancies) held.redundancy = asked.redundancies->front();
  const std::size_t along_x = asked.xs ? asked.xs->size() : 1, along_y = asked.ys ? asked.ys->size() : 1;
  if (along_x > 1 && along_y == 1) {
    held.y = asked.ys->front();
    return Sweep{"part moved along X, mm", "", &Variation::x, 1e3, *asked.xs, held};
  }
  if (along_y > 1 && along_x == 1) {
    held.x = asked.xs->front();
    return Sweep{"part moved along Y, mm", "", &Variation::y, 1e3, *asked.ys, held};
  }
  return std::nullopt;
}

double own_limit(const PostureDirections& posture) { return posture.own_limit; }

// A line a posture; dashed where it lies outside the map, broken where the robot cannot stand.
plot::Panel sweep_panel(const DirectionsResult& result, const Sweep& sweep, const std::string& title,
                        double (*limit)(const PostureDirections&), bool named) {
  plot::Panel panel;
  panel.title = title;
  panel.y = {"limit, mm", 0.0, kNaN};
  panel.x = plot::Axis{sweep.label, sweep.scale * sweep.values.front(), sweep.scale * sweep.values.back()};
  for (std::size_t task = 0; task < result.tasks.size(); ++task) {
    plot::Line inside, all;
    for (const double value : sweep.values) {
      Variation variation = sweep.held;
      variation.*sweep.number = value;
      const PostureDirections* posture = variation_at(result, task, variation);
      const double shown = posture == nullptr ? kNaN : 1e3 * std::min(limit(*posture), result.study.max_depth);
      all.x.push_back(sweep.scale * value);
      all.y.push_back(shown);
      inside.y.push_back(posture == nullptr || posture->predicted.outside ? kNaN : shown);
    }
    inside.x = all.x;
    inside.color = all.color = kTaskColors[task % kTaskColors.size()];
    inside.width = 2.0;
    all.width = 1.0;
    all.dashed = true;
    if (named && result.tasks.size() <= kTaskColors.size()) inside.label = result.tasks[task];
    panel.lines.push_back(std::move(all));
    panel.lines.push_back(std::move(inside));
  }
  return panel;
}

// What every posture takes, over both ways of the part; a cross where some posture is out of reach or of the map.
plot::Panel placement_panel(const DirectionsResult& result) {
  const std::vector<double>&xs = *result.asked.xs, &ys = *result.asked.ys;
  const std::vector<PlacementLimit> placements = placement_limits(result);
  const double half_x = 0.5e3 * (xs[1] - xs[0]), half_y = 0.5e3 * (ys[1] - ys[0]);
  const auto columns = static_cast<int>(xs.size());
  const double top = result.study.max_depth;
  double low = kInfinity, high = 0.0;
  plot::Scatter unknown, best;
  for (const PlacementLimit& at : placements) {
    if (std::isnan(at.limit)) {
      unknown.x.push_back(1e3 * at.x);
      unknown.y.push_back(1e3 * at.y);
      continue;
    }
    low = std::min(low, 1e3 * std::min(at.limit, top));
    high = std::max(high, 1e3 * std::min(at.limit, top));
  }
  if (low > high) low = 0.0;
  if (!(high > low)) high = low + 1e-3;
  plot::Image image;
  image.x_begin = 1e3 * xs.front() - half_x, image.x_end = 1e3 * xs.back() + half_x;
  image.y_begin = 1e3 * ys.front() - half_y, image.y_end = 1e3 * ys.back() + half_y;
  image.columns = columns * kCellPixels;
  image.rows = static_cast<int>(ys.size()) * kCellPixels;
  image.low = low;
  image.high = high;
  image.scale_label = "limit, mm";
  for (int row = 0; row < image.rows; ++row) {
    for (int column = 0; column < image.columns; ++column) {
      const int cell = row / kCellPixels * columns + column / kCellPixels;
      const double limit = placements[static_cast<std::size_t>(cell)].limit;
      image.values.push_back(static_cast<float>(std::isnan(limit) ? low : 1e3 * std::min(limit, top)));
    }
  }
  plot::Panel panel;
  panel.title = "What every posture takes in its best direction";
  panel.y = {"part moved along Y, mm"};
  panel.x = plot::Axis{"part moved along X, mm"};
  panel.image = std::move(image);
  if (const PlacementLimit* found = best_placement(placements); found != nullptr) {
    best.x = {1e3 * found->x};
    best.y = {1e3 * found->y};
    best.color = plot::kVermilion;
    best.size = 12.0;
    best.marker = plot::Marker::diamond;
    best.label = "best placement";
    panel.points.push_back(best);
  }
  if (!unknown.x.empty()) {
    unknown.color = plot::kOrange;
    unknown.size = 9.0;
    unknown.marker = plot::Marker::cross;
    unknown.label = "out of reach or outside the map";
    panel.points.push_back(unknown);
  }
  return panel;
}

}  // namespace

plot::Figure variations_figure(const DirectionsResult& result, double own_direction) {
  const std::optional<Sweep> sweep = sweep_of(result);
  const bool grid = result.asked.xs && result.asked.xs->size() > 1 && result.asked.ys->size() > 1;
  if (!sweep && !grid) return directions_figure(result);
  plot::Figure figure;
  figure.title = "Depth that is stable at every speed, posture by posture";
  figure.subtitle = csv_number(std::round(rad_s_to_rpm(result.study.speeds.front()))) + " to " +
                    csv_number(std::round(rad_s_to_rpm(result.study.speeds.back()))) + " rpm";
  figure.width = 1000;
  figure.height = 120;
  if (sweep) {
    figure.subtitle += sweep->elsewhere + "; dashed: outside the map";
    figure.panels.push_back(sweep_panel(result, *sweep, "Best feed direction", best_limit, true));
    figure.panels.push_back(sweep_panel(result, *sweep, "Worst feed direction", worst_limit, false));
    const double own = std::round(rad_to_deg(own_direction) * 1e3) / 1e3;
    figure.panels.push_back(
        sweep_panel(result, *sweep, "The cell's feed direction, " + csv_number(own) + "°", own_limit, false));
    figure.height += 900;
  }
  if (grid) {
    figure.panels.push_back(placement_panel(result));
    figure.panels.back().height = 2.0;
    figure.height += 700;
  }
  figure.x = *figure.panels.back().x;
  return figure;
}

}  // namespace stillcut
