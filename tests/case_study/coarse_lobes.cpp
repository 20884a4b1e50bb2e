#include "tests/case_study/coarse_lobes.hpp"

#include <algorithm>
#include <cmath>

#include "dsp/numbers.hpp"
#include "models/machining.hpp"
#include "models/zeroth_order.hpp"

namespace stillcut::case_study {
namespace {

std::complex<double> along(std::span<const Mode> modes, std::size_t axis, double frequency) {
  std::complex<double> sum;
  for (const Mode& mode : modes) {
    const double ratio = frequency / mode.natural_frequency, share = mode.direction[axis] * mode.direction[axis];
    if (share > 0.0)
      sum += share / (mode.stiffness * std::complex<double>(1.0 - ratio * ratio, 2.0 * mode.damping_ratio * ratio));
  }
  return sum;
}

// A stretch of a lobe between two frequencies lowers the limits at the speeds that it passes.
void lower(const LinearCut& cut, std::span<const double> speeds, double frequency_a, const LobeBranch& a,
           double frequency_b, const LobeBranch& b, std::vector<double>& limits) {
  const double lowest = speeds.front(), highest = speeds.back();
  const double step = (highest - lowest) / static_cast<double>(speeds.size() - 1);
  for (int lobe = 0;; ++lobe) {
    const double n_a = kTwoPi * frequency_a / (cut.teeth * (a.phase + kTwoPi * lobe));
    const double n_b = kTwoPi * frequency_b / (cut.teeth * (b.phase + kTwoPi * lobe));
    if (std::max(n_a, n_b) < lowest) return;
    if (std::min(n_a, n_b) > highest) continue;
    const double first = std::ceil((std::min(n_a, n_b) - lowest) / step);
    const double last = std::floor((std::max(n_a, n_b) - lowest) / step);
    const auto end = static_cast<std::size_t>(std::clamp(last + 1.0, 0.0, static_cast<double>(speeds.size())));
    for (auto i = static_cast<std::size_t>(std::max(first, 0.0)); i < end; ++i) {
      const double part = n_a == n_b ? 0.0 : (speeds[i] - n_a) / (n_b - n_a);
      limits[i] = std::min(limits[i], std::lerp(a.depth, b.depth, part));
    }
  }
}

}  // namespace

DirectReceptance direct_receptance(std::span<const Mode> modes) {
  DirectReceptance result;
  for (double hz = 40.0; hz < 650.0; hz *= hz < 200.0 ? 1.02 : hz < 430.0 ? 1.05 : hz < 580.0 ? 1.003 : 1.02) {
    result.frequencies.push_back(kTwoPi * hz);
    result.xx.push_back(along(modes, 0, kTwoPi * hz));
    result.yy.push_back(along(modes, 1, kTwoPi * hz));
  }
  return result;
}

std::vector<double> coarse_paper_limits(const LinearCut& cut, const DirectReceptance& receptance, double feed_direction,
                                        std::span<const double> speeds) {
  const double c = std::cos(feed_direction), s = std::sin(feed_direction);
  std::vector<double> limits(speeds.size(), kInfinity);
  std::array<std::complex<double>, 2> before;
  std::array<LobeBranch, 2> branch_before;
  for (std::size_t i = 0; i < receptance.frequencies.size(); ++i) {
    Eigen::Matrix2cd projected = Eigen::Matrix2cd::Zero();
    projected(0, 0) = receptance.xx[i] * c + receptance.yy[i] * s;
    projected(1, 1) = -receptance.xx[i] * s + receptance.yy[i] * c;
    auto pair = oriented_eigenvalues(cut, projected);
    if (i > 0 && std::abs(pair[0] - before[1]) + std::abs(pair[1] - before[0]) <
                     std::abs(pair[0] - before[0]) + std::abs(pair[1] - before[1]))
      std::swap(pair[0], pair[1]);
    std::array<LobeBranch, 2> branch;
    for (std::size_t which = 0; which < 2; ++which) {
      branch[which] = lobe_branch(cut, pair[which]);
      const LobeBranch &a = branch_before[which], &b = branch[which];
      const bool both = i > 0 && a.depth > 0.0 && b.depth > 0.0 && std::abs(a.phase - b.phase) < 2.0;
      if (both) lower(cut, speeds, receptance.frequencies[i - 1], a, receptance.frequencies[i], b, limits);
    }
    before = pair;
    branch_before = branch;
  }
  return limits;
}

}  // namespace stillcut::case_study
