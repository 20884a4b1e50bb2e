// How one vibration mode answers, exactly: free decay, and the convolution of its impulse response with a force that is
// a polynomial over a short stretch of time.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "models/dynamics_map.hpp"
#include "models/gauss_legendre.hpp"

namespace stillcut {

// A mode in normal form: q'' + 2 zeta w q' + w^2 q = gain (u . F). Its state is (q, q'/w), both in m.
struct Oscillator {
  double frequency, decay, damped_frequency;  // rad/s, 1/s, rad/s
  double gain;                                // 1/kg
  Eigen::Vector3d direction;                  // unit

  explicit Oscillator(const Mode& mode);
  Eigen::Matrix2d transition(double time) const;  // of the state, in free motion
  Eigen::Vector2d impulse(double time) const;     // state a time after a unit impulse along the mode
};

// Response over a stretch to a unit force at each node (the polynomial that is 1 there and 0 at the other nodes).
struct ModalResponse {
  std::vector<Eigen::MatrixXd> at_node;  // state at each node: 2 x forced node
  Eigen::MatrixXd end;                   // state at the end: 2 x forced node
};

// A stretch of time with Gauss-Legendre nodes; the tables do not depend on its duration.
class ForcedStretch {
 public:
  explicit ForcedStretch(int nodes);
  Eigen::Index size() const { return rule_.nodes.size(); }
  double node(Eigen::Index i) const { return rule_.nodes[i]; }  // in (0, 1), share of the stretch
  ModalResponse respond(const Oscillator& mode, double duration) const;

 private:
  GaussLegendre rule_;
  std::vector<Eigen::MatrixXd> weights_;  // [node, at last the end]: quadrature point x node
};

}  // namespace stillcut
