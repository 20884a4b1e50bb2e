#include "models/direction_limits.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "models/linear_cut.hpp"
#include "models/lobes.hpp"
#include "models/paper_projection.hpp"
#include "models/receptance.hpp"
#include "models/zeroth_order.hpp"

namespace stillcut {
namespace {

std::vector<DepthLimit> paper_limits(const Tool& tool, const Material& material, const Cut& cut,
                                     std::span<const Mode> modes, const DirectionStudy& study) {
  const auto projected = [&](double frequency) {
    return paper_feed_plane(receptance(modes, frequency), cut.feed_direction);
  };
  return zeroth_order_limits(linear_cut(tool, material, cut), modes, projected, study.speeds, study.max_depth);
}

std::vector<double> limits_at(const Tool& tool, const Material& material, const Cut& cut, std::span<const Mode> modes,
                              const DirectionStudy& study) {
  std::vector<DepthLimit> limits;
  if (study.method == DirectionMethod::paper) {
    limits = paper_limits(tool, material, cut, modes, study);
  } else {
    LobeSettings settings;
    settings.method = study.method == DirectionMethod::floquet ? LobeMethod::floquet : LobeMethod::zeroth_order;
    settings.max_depth = study.max_depth;
    limits = traced_limits(tool, material, cut, modes, study.speeds, settings);
  }
  std::vector<double> depths(limits.size());
  std::transform(limits.begin(), limits.end(), depths.begin(),
                 [](const DepthLimit& limit) { return std::isnan(limit.depth) ? 0.0 : limit.depth; });
  return depths;
}

// Whether b is a's opposite, to the rounding of degrees.
bool are_opposite(double a, double b) {
  return std::abs(std::abs(std::remainder(b - a, kTwoPi)) - std::numbers::pi) < 1e-9;
}

}  // namespace

std::vector<DirectionCurve> limits_over_direction(const Tool& tool, const Material& material, const Cut& cut,
                                                  std::span<const Mode> modes, const DirectionStudy& study) {
  std::vector<DirectionCurve> curves;
  for (const double direction : study.directions) {
    const auto same = std::find_if(curves.begin(), curves.end(), [&](const DirectionCurve& curve) {
      return study.method != DirectionMethod::paper && are_opposite(curve.direction, direction);
    });
    if (same != curves.end()) {
      curves.push_back({direction, same->limits});
      continue;
    }
    Cut turned = cut;
    turned.feed_direction = direction;
    curves.push_back({direction, limits_at(tool, material, turned, modes, study)});
    if (study.sense == CutSense::as_set || opposite(cut.milling) == cut.milling) continue;
    turned.milling = opposite(cut.milling);
    const std::vector<double> back = limits_at(tool, material, turned, modes, study);
    std::vector<double>& limits = curves.back().limits;
    std::transform(limits.begin(), limits.end(), back.begin(), limits.begin(),
                   [](double forth, double other) { return std::min(forth, other); });
  }
  return curves;
}

double absolute_limit(std::span<const double> limits) {
  if (limits.empty()) throw std::invalid_argument("absolute limit: needs at least one speed");
  return *std::min_element(limits.begin(), limits.end());
}

Pocket deepest_pocket(std::span<const double> limits, std::span<const double> speeds) {
  if (limits.empty() || limits.size() != speeds.size()) throw std::invalid_argument("pocket: needs one limit a speed");
  const double deepest = *std::max_element(limits.begin(), limits.end());
  std::size_t best_begin = 0, best_end = 0;
  for (std::size_t i = 0; i < limits.size();) {
    if (limits[i] != deepest) {
      ++i;
      continue;
    }
    std::size_t end = i;
    while (end < limits.size() && limits[end] == deepest) ++end;
    if (end - i > best_end - best_begin) best_begin = i, best_end = end;
    i = end;
  }
  return {deepest, speeds[(best_begin + best_end - 1) / 2]};
}

std::vector<double> directions_around(double step) {
  if (!(step > 0.0 && step <= std::numbers::pi))
    throw std::invalid_argument("step of direction: above 0, up to 180 degrees");
  const auto count = static_cast<std::size_t>(std::ceil(kTwoPi / step - 1e-9));
  std::vector<double> directions(count);
  for (std::size_t i = 0; i < count; ++i) directions[i] = static_cast<double>(i) * step;
  return directions;
}

}  // namespace stillcut
