// What one period does to a small disturbance of the cut: the period map (monodromy) of the linear delay equations of
// milling, solved by collocation. Its largest multiplier decides stability (Floquet).
//
// Between entries and exits the structure answers freely, so its response to a force is known exactly: modal free decay
// plus the convolution with the impulse response. The only unknown is the chip thickness each tooth cuts; it is smooth
// between breakpoints, so its values at a few Gauss-Legendre nodes of each stretch determine it with spectral accuracy.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "models/dynamics_map.hpp"
#include "models/linear_cut.hpp"
#include "models/modal_response.hpp"

namespace stillcut {

// How finely the cut is divided: stretches of at most cycles_per_stretch cycles, each with nodes + nodes_per_cycle x
// cycles nodes. Cycles are those of the highest mode, stiffened by the cut, and of the turning of the tool (one each
// half turn).
struct Collocation {
  double nodes = 7.0;
  double nodes_per_cycle = 4.0;
  double cycles_per_stretch = 4.0;
};

// A part of the period, at whose nodes `rows` displacements are observed: y = of_state s - depth of_chip c, where s is
// the modal state (q, q'/w of each mode, m) at its start and c the chip: y minus what the tool left there a delay ago,
// in m. Where process damping acts, as many rows of velocities follow, whose chip is themselves. In free flight there
// are no rows.
struct StretchMap {
  double from = 0.0, angle = 0.0;  // spindle angle at its start, and its length, rad
  double duration = 0.0;           // s
  int nodes = 0;
  int rows = 0;                       // displacements observed at a node
  int positions = 0;                  // nodes x rows
  std::vector<int> tooth;             // of each of a node's rows: whose delay it has
  std::vector<Eigen::Matrix2d> free;  // of each mode: state at the end per state at the start
  Eigen::MatrixXd of_state;           // all rows x states
  RowMatrix of_chip;                  // all rows x all rows
  Eigen::MatrixXd end_of_chip;        // states x all rows: s' = free s - depth end_of_chip c
  Eigen::MatrixXd observe;            // 3 x positions: the direction of each displacement
  Eigen::MatrixXd load;               // 3 x all rows: force per chip and depth, N/m^2
};

struct PeriodMap {
  int states = 0;     // two a mode
  int positions = 0;  // of all stretches
  std::vector<StretchMap> stretches;
};

// The map for modes in the feed frame at a spindle speed in rad/s. `depth` (m) places the edge of helical teeth and
// ball ends, otherwise the map holds at any depth (depends_on_depth). `deepest` is the largest depth it has to be
// accurate at. Throws std::invalid_argument for a speed that is not positive, or so low that a mode vibrates more than
// 2000 times in a period, for a negative depth, and for modes that check_modes refuses.
PeriodMap period_map(const LinearCut& cut, std::span<const Mode> feed_frame_modes, double speed, double depth,
                     double deepest, const Collocation& collocation);

bool depends_on_depth(const LinearCut& cut);

}  // namespace stillcut
