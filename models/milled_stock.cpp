#include "models/milled_stock.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

namespace stillcut {
namespace {

// Bilinear between points, a ball's surface is off by the spacing squared over 8 R: 13 nm of a chip of micrometres at
// the second bound. Feed marks are far lower than a chip.
constexpr double kOfFeed = 0.8, kOfRadius = 5e-3;
constexpr double kMargin = 4.0;           // points
constexpr double kMostStockPoints = 1e8;  // 0.8 GB

double sphere_height(double radius, double squared_distance) {
  return squared_distance < radius * radius ? radius - std::sqrt(radius * radius - squared_distance)
                                            : std::numeric_limits<double>::infinity();
}

double sign_of(const CutterPass& pass) { return pass.reversed ? -1.0 : 1.0; }

}  // namespace

double contact_reach(const Tool& tool, double axial_depth) {
  const double radius = 0.5 * tool.diameter, depth = std::min(axial_depth, radius);
  return std::sqrt(depth * (2.0 * radius - depth));
}

// On the ball x^2 = 2 a_e y + a_e^2 is where it meets the neighbour's groove.
double end_reach(const Tool& tool, const Cut& cut) {
  const double step_over = step_over_of(cut);
  return std::sqrt(step_over * (2.0 * contact_reach(tool, cut.axial_depth) + step_over));
}

Stock stock_for(const Tool& tool, const Cut& cut, std::span<const CutterPass> passes) {
  const double radius = 0.5 * tool.diameter, step_over = step_over_of(cut);
  const double spacing = std::min(kOfFeed * std::min(cut.feed_per_tooth, step_over), kOfRadius * radius);
  const double margin = contact_reach(tool, cut.axial_depth) + kMargin * spacing;
  double low_x = std::numeric_limits<double>::infinity(), low_y = low_x, high_x = -low_x, high_y = -low_x;
  for (const CutterPass& pass : passes) {
    const double end = pass.begin + sign_of(pass) * pass.length;
    low_x = std::min({low_x, pass.begin, end}), high_x = std::max({high_x, pass.begin, end});
    low_y = std::min(low_y, pass.across), high_y = std::max(high_y, pass.across);
  }
  Stock stock;
  stock.origin_x = low_x - margin;
  stock.origin_y = low_y - margin;
  HeightMap& map = stock.map;
  map.spacing_along = map.spacing_across = spacing;
  map.along = static_cast<std::size_t>(std::ceil((high_x - low_x + 2.0 * margin) / spacing)) + 1;
  map.across = static_cast<std::size_t>(std::ceil((high_y - low_y + 2.0 * margin) / spacing)) + 1;
  if (!(static_cast<double>(map.along) * static_cast<double>(map.across) <= kMostStockPoints))
    throw std::invalid_argument("the stock around the passes would have more than 100 million points, " +
                                std::to_string(1e6 * spacing) +
                                " um apart; make the surface smaller or raise the feed or the step-over");
  map.heights.reserve(map.along * map.across);
  const double forward = passes.back().across >= passes.front().across ? 1.0 : -1.0;
  for (std::size_t j = 0; j < map.across; ++j) {
    // Of all grooves on that side the nearest is the deepest.
    const double behind = forward * (passes.front().across - (stock.origin_y + static_cast<double>(j) * spacing));
    const double away = behind - step_over * std::max(1.0, std::round(behind / step_over));
    map.heights.insert(map.heights.end(), map.along, std::min(cut.axial_depth, sphere_height(radius, away * away)));
  }
  return stock;
}

void cut_up_to_begin(const Tool& tool, const CutterPass& pass, Stock& stock) {
  const double runout = std::hypot(tool.runout, tool.axial_runout), radius = 0.5 * tool.diameter + runout;
  HeightMap& map = stock.map;
  for (std::size_t j = 0; j < map.across; ++j) {
    const double across = stock.origin_y + static_cast<double>(j) * map.spacing_across - pass.across;
    if (!(std::abs(across) < radius)) continue;
    for (std::size_t i = 0; i < map.along; ++i) {
      const double x = stock.origin_x + static_cast<double>(i) * map.spacing_along;
      const double ahead = std::max(0.0, sign_of(pass) * (x - pass.begin));
      double& height = map.at(i, j);
      height = std::min(height, sphere_height(radius, across * across + ahead * ahead) - runout);
    }
  }
}

}  // namespace stillcut
