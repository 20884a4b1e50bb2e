#include "models/edge_elements.hpp"

#include <algorithm>
#include <cmath>

namespace stillcut {
namespace {

constexpr double kLargestLag = 0.035;  // rad between neighbours
constexpr int kFewestOnBall = 12;

double lag_per_height(const Tool& tool) { return std::tan(tool.helix) / (0.5 * tool.diameter); }

}  // namespace

double profile_length(const Tool& tool, double depth) {
  const double radius = 0.5 * tool.diameter;
  if (tool.shape == ToolShape::end) return depth;
  return radius * std::acos(1.0 - std::min(depth, radius) / radius) + std::max(0.0, depth - radius);
}

int edge_element_count(const Tool& tool, double depth) {
  const double lag = profile_length(tool, depth) * std::abs(lag_per_height(tool));
  return std::max(tool.shape == ToolShape::ball ? kFewestOnBall : 1, static_cast<int>(std::ceil(lag / kLargestLag)));
}

std::vector<EdgeElement> edge_elements(const Tool& tool, double depth, int count) {
  const double radius = 0.5 * tool.diameter, width = profile_length(tool, depth) / count;
  const bool ball = tool.shape == ToolShape::ball;
  std::vector<EdgeElement> elements(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    EdgeElement& piece = elements[static_cast<std::size_t>(i)];
    const double along = (i + 0.5) * width;
    double height = along;
    if (ball) {
      const double kappa = std::min(along / radius, 0.5 * std::numbers::pi);
      piece.sin_kappa = std::sin(kappa);
      piece.cos_kappa = std::cos(kappa);
      height = radius * (1.0 - piece.cos_kappa) + std::max(0.0, along - 0.5 * std::numbers::pi * radius);
    }
    piece.lag = height * lag_per_height(tool);
    piece.chip_width = width;
    // Around the axis the edge advances by its local radius times the lag; dz = width sin kappa.
    const double around = radius * piece.sin_kappa * width * piece.sin_kappa * lag_per_height(tool);
    piece.edge_length = ball ? std::hypot(width, around) : width;
  }
  return elements;
}

}  // namespace stillcut
