#include "models/wall_heights.hpp"

#include <algorithm>
#include <cmath>

#include "dsp/numbers.hpp"

namespace stillcut {
namespace {

constexpr double kFarthestArc = 0.5e-3;  // m: an arc that far away is 12 um lower with a tool of 20 mm

}  // namespace

std::vector<double> wall_heights(std::span<const ToothPass> passes, double tool_radius, double from, double spacing,
                                 std::size_t count) {
  std::vector<double> heights(count);
  auto first = std::partition_point(passes.begin(), passes.end(),
                                    [&](const ToothPass& pass) { return pass.along < from - kFarthestArc; });
  for (std::size_t i = 0; i < count; ++i) {
    const double x = from + spacing * static_cast<double>(i);
    while (first != passes.end() && first->along < x - kFarthestArc) ++first;
    double deepest = -kInfinity;
    for (auto pass = first; pass != passes.end() && pass->along <= x + kFarthestArc; ++pass) {
      const double away = x - pass->along;
      deepest = std::max(deepest, pass->reach - away * away / (2.0 * tool_radius));
    }
    heights[i] = std::isfinite(deepest) ? deepest : kNaN;
  }
  return heights;
}

}  // namespace stillcut
