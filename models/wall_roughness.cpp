#include "models/wall_roughness.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "models/wall_profile.hpp"

namespace stillcut {
namespace {

constexpr std::size_t kPoints = 160;  // a sampling length: 5 um apart
constexpr double kFarthest = 0.5e-3;  // m: an arc that far away is 12 um lower with a tool of 20 mm

}  // namespace

std::vector<double> wall_heights(std::span<const ToothPass> passes, double tool_radius, double from, double spacing,
                                 std::size_t count) {
  std::vector<double> heights(count);
  auto first = std::partition_point(passes.begin(), passes.end(),
                                    [&](const ToothPass& pass) { return pass.along < from - kFarthest; });
  for (std::size_t i = 0; i < count; ++i) {
    const double x = from + spacing * static_cast<double>(i);
    while (first != passes.end() && first->along < x - kFarthest) ++first;
    double deepest = -std::numeric_limits<double>::infinity();
    for (auto pass = first; pass != passes.end() && pass->along <= x + kFarthest; ++pass) {
      const double away = x - pass->along;
      deepest = std::max(deepest, pass->reach - away * away / (2.0 * tool_radius));
    }
    heights[i] = deepest;
  }
  return heights;
}

double wall_roughness_at(std::span<const ToothPass> passes, double tool_radius, double from) {
  constexpr double kSpacing = kWallSamplingLength / kPoints;
  const std::vector<double> heights = wall_heights(passes, tool_radius, from, kSpacing, kPoints);
  const bool covered = std::all_of(heights.begin(), heights.end(), [](double h) { return std::isfinite(h); });
  return covered ? roughness(heights, kSpacing).ra : std::numeric_limits<double>::quiet_NaN();
}

double wall_roughness(std::span<const ToothPass> passes, double tool_radius) {
  double sum = 0.0;
  int lengths = 0;
  const double start = passes.empty() ? 0.0 : passes.front().along, end = passes.empty() ? 0.0 : passes.back().along;
  for (double from = start; from + kWallSamplingLength <= end; from += kWallSamplingLength) {
    const double ra = wall_roughness_at(passes, tool_radius, from);
    if (std::isnan(ra)) continue;  // the tool was out of the part
    sum += ra;
    ++lengths;
  }
  return lengths > 0 ? sum / lengths : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace stillcut
