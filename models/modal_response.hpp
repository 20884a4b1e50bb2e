// How one vibration mode answers, exactly: free decay, and the convolution of its impulse response with a force that is
// a polynomial over a short stretch of time.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "models/dynamics_map.hpp"
#include "models/gauss_legendre.hpp"

namespace stillcut {

using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// A mode in normal form: q'' + 2 zeta w q' + w^2 q = gain (u . F). Its state is (q, q'/w), both in m.
struct Oscillator {
  double frequency, decay, damped_frequency;  // rad/s, 1/s, rad/s
  double gain;                                // 1/kg
  Eigen::Vector3d direction;                  // unit

  explicit Oscillator(const Mode& mode);
  Eigen::Matrix2d transition(double time) const;  // of the state, in free motion
  Eigen::Vector2d impulse(double time) const;     // state a time after a unit impulse along the mode
};

// What a mode does over a stretch of time, in free motion from the state at its start and under a unit force at each
// node (the polynomial that is 1 there and 0 at the other nodes).
struct ModalResponse {
  Eigen::Matrix2d free_end;  // state at the end per state at the start
  RowMatrix free;            // q at each node per state at the start: 2 x nodes
  RowMatrix forced;          // q at each node per forced node: nodes x nodes
  RowMatrix forced_end;      // state at the end per forced node: 2 x nodes
  RowMatrix free_rate;       // as `free` and `forced`, of q'/w; empty unless asked for
  RowMatrix forced_rate;
};

// A stretch of time with Gauss-Legendre nodes; the tables do not depend on its duration.
class ForcedStretch {
 public:
  explicit ForcedStretch(int nodes);
  int size() const { return static_cast<int>(rule_.nodes.size()); }
  const Eigen::VectorXd& nodes() const { return rule_.nodes; }  // in (0, 1), shares of the stretch

  // Duration in s. `response` keeps its memory from call to call.
  void respond(const Oscillator& mode, double duration, bool with_rates, ModalResponse& response) const;

  // q a time after the stretch's start, 0 to its duration (s), per state at the start and per forced node:
  // 1 x (2 + nodes).
  Eigen::RowVectorXd displacement_at(const Oscillator& mode, double duration, double time) const;

 private:
  GaussLegendre rule_;
  std::vector<double> times_;  // shares of the duration at which decays are needed: x_i x_k (k <= i), then x_i
  // How a force at each node enters the quadrature for the answer at node i (at last: at the end), by the decay from
  // the quadrature point to the node: [i][decay k][node j].
  std::vector<double> weights_;
};

// The tables for a node count (1 to 128), made at their first use. Any thread.
const ForcedStretch& forced_stretch(int nodes);

}  // namespace stillcut
