// Stability lobe diagrams: computed for a posture on ordinary threads, looked up by the real-time thread in constant
// time.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "models/depth_limit.hpp"
#include "models/dynamics_map.hpp"
#include "models/lobe_diagram.hpp"
#include "models/machining.hpp"

namespace stillcut {

enum class LobeMethod { floquet, zeroth_order };

inline constexpr int kMostFloquetModes = 64;

struct LobeSettings {
  LobeMethod method = LobeMethod::floquet;
  double max_depth = 0.02;  // m
  int points = 201;         // of a LobeDiagram, 2 to LobeDiagram::kMaxPoints
};

// Speeds from first to last, both included, equally spaced (rad/s). Throws std::invalid_argument for speeds that are
// not positive and rising or a count below 1; a count of 1 gives `first`.
std::vector<double> equally_spaced_speeds(double first, double last, int count);

// Depth limits at the given speeds (rad/s) for modes in workpiece axes; the cut's own speed and depth play no part.
// Throws std::invalid_argument for what cannot be computed, and for more than kMostFloquetModes modes with the Floquet
// method: its cost grows with their cube. `progress` is told the share done, 0 to 1.
std::vector<DepthLimit> depth_limits(const Tool& tool, const Material& material, const Cut& cut,
                                     std::span<const Mode> modes, std::span<const double> speeds,
                                     const LobeSettings& settings, const std::function<void(double)>& progress = {});

// The same with the boundary traced from speed to speed (lobe_trace.hpp), many times faster: within the trace's
// tolerance, and blind to an unstable island narrower than three of the speeds, which are best close together.
std::vector<DepthLimit> traced_limits(const Tool& tool, const Material& material, const Cut& cut,
                                      std::span<const Mode> modes, std::span<const double> speeds,
                                      const LobeSettings& settings);

// The diagram over the spindle's range, traced, ready for the real-time thread but for its stamps. Of more than
// kMaxModes modes the summary names the most compliant. Throws as above.
LobeDiagram compute_lobe_diagram(const Tool& tool, const Material& material, const Cut& cut,
                                 const SpindleLimits& spindle, std::span<const Mode> modes,
                                 const LobeSettings& settings = {});

// Fills in the modes that move most, as many as the diagram has room for, in rising frequency.
void summarise_modes(std::span<const Mode> modes, LobeDiagram& diagram);

}  // namespace stillcut
