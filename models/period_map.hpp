// What one tooth period does to a small disturbance of the cut: the period map (monodromy) of the linear delay
// equations of milling, solved by collocation. Its largest multiplier decides stability (Floquet).
//
// Between entries and exits the structure answers freely, so its response to a force is known exactly: modal free decay
// plus the convolution with the impulse response. The only unknown is the chip thickness each tooth cuts; it is smooth
// between breakpoints, so its values at a few Gauss-Legendre nodes of each piece determine it with spectral accuracy.
// The map acts on the modal state at tooth entry together with the tool's displacement at the nodes one period ago.
#pragma once

#include <Eigen/Core>
#include <span>

#include "models/dynamics_map.hpp"
#include "models/linear_cut.hpp"

namespace stillcut {

// How finely a cutting piece is divided: stretches of at most four cycles, each with nodes + nodes_per_cycle x cycles
// nodes. Cycles are those of the highest mode plus one for each half turn of the tool.
struct Collocation {
  double nodes = 7.0;
  double nodes_per_cycle = 4.0;
};

// Everything that depends on the speed but, for straight teeth, not on the depth:
//   y  = observed_of_state s - depth * observed_of_chip c,   s' = state_of_state s - depth * state_of_chip c,
// with s the state at the start of the period (displacement and velocity/frequency of each mode, m), s' at its end, y
// what is observed at the nodes (positions, then velocities where process damping needs them), c = y minus, for
// positions, the same a period ago.
struct PeriodMap {
  double period = 0.0;         // s
  Eigen::Index positions = 0;  // observed positions; velocities, if any, are as many
  Eigen::MatrixXd observed_of_state, observed_of_chip, state_of_state, state_of_chip;
};

// The map for modes in the feed frame at a spindle speed in rad/s. `depth` places the ends of helical teeth and is
// otherwise unused. Throws std::invalid_argument for a speed that is not positive, or so low that a mode vibrates more
// than 120 times while a tooth cuts, for a negative depth, and for modes that check_modes refuses.
PeriodMap period_map(const LinearCut& cut, std::span<const Mode> feed_frame_modes, double speed, double depth,
                     const Collocation& collocation);

// The monodromy matrix at a depth (m): (s, positions a period ago) to (s', positions now).
Eigen::MatrixXd monodromy(const PeriodMap& map, double depth);

}  // namespace stillcut
