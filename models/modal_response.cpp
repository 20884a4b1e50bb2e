#include "models/modal_response.hpp"

#include <cmath>
#include <utility>

namespace stillcut {

using Eigen::Index;

Oscillator::Oscillator(const Mode& mode)
    : frequency(mode.natural_frequency),
      decay(mode.damping_ratio * mode.natural_frequency),
      damped_frequency(mode.natural_frequency * std::sqrt(1.0 - mode.damping_ratio * mode.damping_ratio)),
      gain(mode.natural_frequency * mode.natural_frequency / mode.stiffness),
      direction(Eigen::Vector3d(mode.direction.data()).normalized()) {}

Eigen::Matrix2d Oscillator::transition(double time) const {
  const double e = std::exp(-decay * time), c = e * std::cos(damped_frequency * time);
  const double s = e * std::sin(damped_frequency * time) / damped_frequency;
  return Eigen::Matrix2d{{c + decay * s, frequency * s}, {-frequency * s, c - decay * s}};
}

Eigen::Vector2d Oscillator::impulse(double time) const { return transition(time).col(1) * (gain / frequency); }

ForcedStretch::ForcedStretch(int nodes) : rule_(gauss_legendre(nodes)) {
  // A force's share in the answer at time t is its integral over [0, t]: the rule squeezed into [0, t].
  for (Index i = 0; i <= size(); ++i) {
    const double until = i < size() ? node(i) : 1.0;
    weights_.push_back(until * rule_.weights.asDiagonal() * lagrange_basis(rule_.nodes, until * rule_.nodes));
  }
}

ModalResponse ForcedStretch::respond(const Oscillator& mode, double duration) const {
  const Index n = size();
  ModalResponse response;
  response.at_node.reserve(static_cast<std::size_t>(n));
  Eigen::MatrixXd kernel(2, n);
  for (Index i = 0; i <= n; ++i) {
    const double until = duration * (i < n ? node(i) : 1.0);
    for (Index k = 0; k < n; ++k) kernel.col(k) = duration * mode.impulse(until * (1.0 - node(k)));
    Eigen::MatrixXd state = kernel * weights_[static_cast<std::size_t>(i)];
    (i < n ? response.at_node.emplace_back() : response.end) = std::move(state);
  }
  return response;
}

}  // namespace stillcut
