#include "models/mode_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace stillcut {
namespace {

using Eigen::Index;

constexpr std::array kDampings{0.001, 0.0025, 0.006, 0.015, 0.035, 0.08, 0.2, 0.4};
constexpr double kStepHalfWidths = 0.5;   // of the half-width zeta w from one frequency to the next
constexpr double kReachHalfWidths = 8.0;  // on both sides of it
constexpr Index kLeastLinesReached = 6;   // lines

}  // namespace

std::vector<MissingMode> missing_modes(const std::vector<Eigen::VectorXcd>& left_over, const FrfLines& lines,
                                       const FrfWeights& weights) {
  std::vector<MissingMode> found;
  const Eigen::VectorXd& omega = lines.omega;
  const Index count = omega.size();
  for (const double damping : kDampings) {
    MissingMode best;
    for (Index at = 0; at < count;) {
      const double frequency = omega[at], half_width = damping * frequency;
      const auto index_of = [&](double w) {
        return std::lower_bound(omega.data(), omega.data() + count, w) - omega.data();
      };
      const Index first =
          std::max<Index>(0, std::min(at - kLeastLinesReached, index_of(frequency - kReachHalfWidths * half_width)));
      const Index end =
          std::min(count, std::max(at + kLeastLinesReached, index_of(frequency + kReachHalfWidths * half_width)));
      const Pole pole{frequency, damping};
      const Eigen::VectorXcd g = pole_response(pole, omega.segment(first, end - first));
      double gain = 0.0;
      for (std::size_t e = 0; e < left_over.size(); ++e) {
        const auto weight = weights[e].segment(first, end - first);
        double match = 0.0, power = 0.0;
        for (Index n = 0; n < g.size(); ++n) {
          match += weight[n] * (std::conj(g[n]) * left_over[e][first + n]).real();
          power += weight[n] * std::norm(g[n]);
        }
        gain += match * match / power;
      }
      if (gain > best.gain) best = {pole, gain};
      const Index next = index_of(frequency + kStepHalfWidths * half_width);
      at = std::max(at + 1, next);
    }
    if (best.gain > 0.0) found.push_back(best);
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const MissingMode& a, const MissingMode& b) { return a.gain > b.gain; });
  return found;
}

}  // namespace stillcut
