// How deep may be cut in which feed direction at one posture (feed-direction paper, sections 5.1 and 5.2). A robot's
// receptance is not the same in all directions, so its limits turn with the feed.
#pragma once

#include <span>
#include <vector>

#include "models/dynamics_map.hpp"
#include "models/machining.hpp"

namespace stillcut {

// floquet is what may be trusted. zeroth_order turns the receptance as the tensor it is; paper projects it as the paper
// does (models/paper_projection.hpp), to reproduce its figures.
enum class DirectionMethod { floquet, zeroth_order, paper };

// A pattern of lines to and fro cuts down one way and up the other; its limit is the lower of the two.
enum class CutSense { as_set, alternating };

struct DirectionStudy {
  std::vector<double> directions;  // rad, workpiece, from +X toward +Y
  std::vector<double> speeds;      // rad/s, rising, close together (models/lobe_trace.hpp)
  DirectionMethod method = DirectionMethod::floquet;
  CutSense sense = CutSense::as_set;
  double max_depth = 0.02;  // m
};

struct DirectionCurve {
  double direction = 0.0;      // rad
  std::vector<double> limits;  // m, one a speed; 0: unstable at every depth, +inf: stable up to the largest depth
};

// The limits in every direction, in their order. A direction and its opposite have the same limits (but for the
// paper's projection), and are computed once. Throws std::invalid_argument for what the lobes cannot be computed of.
std::vector<DirectionCurve> limits_over_direction(const Tool& tool, const Material& material, const Cut& cut,
                                                  std::span<const Mode> modes, const DirectionStudy& study);

// The lowest limit over the speeds: what is stable at each of them (a_abs).
double absolute_limit(std::span<const double> limits);

// The highest one and where: of several speeds that allow as much, the middle of the widest run.
struct Pocket {
  double depth = 0.0;  // m
  double speed = 0.0;  // rad/s
};
Pocket deepest_pocket(std::span<const double> limits, std::span<const double> speeds);

// Directions from 0 on, `step` apart, below a full turn (rad). Throws std::invalid_argument unless 0 < step <= pi.
std::vector<double> directions_around(double step);

}  // namespace stillcut
