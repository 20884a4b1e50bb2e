#include "models/wall_roughness.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace stillcut {
namespace {

constexpr double kSamplingLength = 0.8e-3;  // m
constexpr std::size_t kPoints = 160;        // a sampling length: 5 um apart
constexpr double kFarthest = 0.5e-3;        // m: an arc that far away is 12 um lower with a tool of 20 mm

// Mean distance from the least-squares line through equally spaced heights.
double mean_deviation(const std::vector<double>& height) {
  const auto n = static_cast<double>(height.size());
  double mean = 0.0, slope = 0.0, spread = 0.0;
  for (const double h : height) mean += h / n;
  const double middle = 0.5 * (n - 1.0);
  for (std::size_t i = 0; i < height.size(); ++i) {
    const double x = static_cast<double>(i) - middle;
    slope += x * (height[i] - mean);
    spread += x * x;
  }
  slope /= spread;
  double sum = 0.0;
  for (std::size_t i = 0; i < height.size(); ++i)
    sum += std::abs(height[i] - mean - slope * (static_cast<double>(i) - middle));
  return sum / n;
}

}  // namespace

double wall_roughness(std::span<const ToothPass> passes, double tool_radius) {
  double sum = 0.0;
  int lengths = 0;
  std::size_t first = 0;
  std::vector<double> height(kPoints);
  const double start = passes.empty() ? 0.0 : passes.front().along, end = passes.empty() ? 0.0 : passes.back().along;
  for (double from = start; from + kSamplingLength <= end; from += kSamplingLength) {
    bool covered = true;
    for (std::size_t i = 0; i < kPoints; ++i) {
      const double x = from + kSamplingLength * static_cast<double>(i) / static_cast<double>(kPoints);
      while (first < passes.size() && passes[first].along < x - kFarthest) ++first;
      double deepest = -std::numeric_limits<double>::infinity();
      for (std::size_t p = first; p < passes.size() && passes[p].along <= x + kFarthest; ++p) {
        const double away = x - passes[p].along;
        deepest = std::max(deepest, passes[p].reach - away * away / (2.0 * tool_radius));
      }
      covered = covered && std::isfinite(deepest);
      height[i] = deepest;
    }
    if (!covered) continue;  // the tool was out of the part
    sum += mean_deviation(height);
    ++lengths;
  }
  return lengths > 0 ? sum / lengths : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace stillcut
