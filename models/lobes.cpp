#include "models/lobes.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "dsp/numbers.hpp"
#include "models/floquet.hpp"
#include "models/linear_cut.hpp"
#include "models/lobe_trace.hpp"
#include "models/receptance.hpp"
#include "models/zeroth_order.hpp"

namespace stillcut {
namespace {

// How the Floquet limits at the given speeds are found.
using FloquetLimits = std::function<std::vector<DepthLimit>(const LinearCut&, std::span<const Mode> feed_frame_modes)>;

// Limits by the method asked; what is computed is checked and turned into the feed frame here.
std::vector<DepthLimit> limits_by(const FloquetLimits& floquet, const Tool& tool, const Material& material,
                                  const Cut& cut, std::span<const Mode> modes, std::span<const double> speeds,
                                  const LobeSettings& settings) {
  check_modes(modes);
  const LinearCut linear = linear_cut(tool, material, cut);
  const std::vector<Mode> turned = modes_in_feed_frame(modes, cut.feed_direction);
  if (settings.method == LobeMethod::zeroth_order) {
    return zeroth_order_limits(linear, turned, speeds, settings.max_depth);
  }
  if (modes.size() > kMostFloquetModes) {
    throw std::invalid_argument("the Floquet lobes take at most " + std::to_string(kMostFloquetModes) + " modes, not " +
                                std::to_string(modes.size()) +
                                "; leave out those that matter least, or use method zoa");
  }
  return floquet(linear, turned);
}

}  // namespace

void summarise_modes(std::span<const Mode> modes, LobeDiagram& diagram) {
  std::vector<Mode> chosen(modes.begin(), modes.end());
  const auto peak_compliance = [](const Mode& mode) { return 1.0 / (2.0 * mode.damping_ratio * mode.stiffness); };
  std::stable_sort(chosen.begin(), chosen.end(),
                   [&](const Mode& a, const Mode& b) { return peak_compliance(a) > peak_compliance(b); });
  chosen.resize(std::min<std::size_t>(chosen.size(), LobeDiagram::kMaxModes));
  sort_modes(chosen);
  diagram.mode_count = static_cast<int>(chosen.size());
  std::transform(chosen.begin(), chosen.end(), diagram.modes.begin(), [](const Mode& mode) {
    return ModeSummary{mode.natural_frequency / kTwoPi, mode.damping_ratio};
  });
}

std::vector<double> equally_spaced_speeds(double first, double last, int count) {
  if (count < 1) throw std::invalid_argument("count of speeds: must be at least 1");
  if (!(first > 0.0) || !std::isfinite(last) || last < first || (count > 1 && last == first)) {
    throw std::invalid_argument("speeds: must be positive and rise from the first to the last");
  }
  std::vector<double> speeds;
  speeds.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    speeds.push_back(i + 1 == count && count > 1 ? last : first + (last - first) * i / std::max(1, count - 1));
  }
  return speeds;
}

std::vector<DepthLimit> depth_limits(const Tool& tool, const Material& material, const Cut& cut,
                                     std::span<const Mode> modes, std::span<const double> speeds,
                                     const LobeSettings& settings, const std::function<void(double)>& progress) {
  const auto search = [&](const LinearCut& linear, std::span<const Mode> turned) {
    std::vector<DepthLimit> limits;
    for (const double speed : speeds) {
      limits.push_back(floquet_depth_limit(linear, turned, speed, {.max_depth = settings.max_depth}));
      if (progress) progress(static_cast<double>(limits.size()) / static_cast<double>(speeds.size()));
    }
    return limits;
  };
  return limits_by(search, tool, material, cut, modes, speeds, settings);
}

std::vector<DepthLimit> traced_limits(const Tool& tool, const Material& material, const Cut& cut,
                                      std::span<const Mode> modes, std::span<const double> speeds,
                                      const LobeSettings& settings) {
  const auto trace = [&](const LinearCut& linear, std::span<const Mode> turned) {
    return traced_depth_limits(linear, turned, speeds, {.max_depth = settings.max_depth});
  };
  return limits_by(trace, tool, material, cut, modes, speeds, settings);
}

LobeDiagram compute_lobe_diagram(const Tool& tool, const Material& material, const Cut& cut,
                                 const SpindleLimits& spindle, std::span<const Mode> modes,
                                 const LobeSettings& settings) {
  if (settings.points < 2 || settings.points > LobeDiagram::kMaxPoints) {
    throw std::invalid_argument("lobe diagram: needs 2 to " + std::to_string(LobeDiagram::kMaxPoints) + " points");
  }
  const std::vector<double> speeds = equally_spaced_speeds(spindle.min_speed, spindle.max_speed, settings.points);
  const std::vector<DepthLimit> limits = traced_limits(tool, material, cut, modes, speeds, settings);
  LobeDiagram diagram;
  diagram.point_count = settings.points;
  for (std::size_t i = 0; i < limits.size(); ++i) {
    diagram.points[i] = {speeds[i], limits[i].depth, limits[i].chatter_frequency / kTwoPi};
  }
  summarise_modes(modes, diagram);
  diagram.valid = true;
  return diagram;
}

}  // namespace stillcut
