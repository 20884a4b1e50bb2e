#include "models/wall_roughness.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "models/wall_profile.hpp"

namespace stillcut {
namespace {

constexpr double kSamplingLength = 0.8e-3;  // m
constexpr std::size_t kPoints = 160;        // a sampling length: 5 um apart
constexpr double kFarthest = 0.5e-3;        // m: an arc that far away is 12 um lower with a tool of 20 mm

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
    sum += roughness(height, kSamplingLength / kPoints).ra;
    ++lengths;
  }
  return lengths > 0 ? sum / lengths : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace stillcut
