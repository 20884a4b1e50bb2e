#include "models/zeroth_order.hpp"

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "dsp/numbers.hpp"
#include "models/receptance.hpp"

namespace stillcut {
namespace {

using Complex = std::complex<double>;
using Pair = std::array<Complex, 2>;

// The pair in the order that continues `before`: the eigenvalues of neighbouring frequencies belong together.
Pair continued(Pair pair, const Pair& before) {
  const double straight = std::abs(pair[0] - before[0]) + std::abs(pair[1] - before[1]);
  const double crossed = std::abs(pair[0] - before[1]) + std::abs(pair[1] - before[0]);
  if (crossed < straight) std::swap(pair[0], pair[1]);
  return pair;
}

Eigen::Matrix2cd in_feed_plane(std::span<const Mode> feed_frame_modes, double frequency) {
  return receptance(feed_frame_modes, frequency).topLeftCorner<2, 2>();
}

// Frequencies dense where a mode's response turns (spacing a fraction of its width), and dense enough everywhere that
// the phase between waves turns little from one to the next even at the lowest speed.
std::vector<double> frequency_grid(std::span<const Mode> modes, double longest_period) {
  double highest = 0.0;
  for (const Mode& mode : modes) highest = std::max(highest, mode.natural_frequency);
  const double top = 4.0 * highest, step = std::min(kTwoPi / (24.0 * longest_period), top / 2000.0);
  std::vector<double> grid;
  for (double frequency = step; frequency < top; frequency += step) grid.push_back(frequency);
  for (const Mode& mode : modes) {
    const double width = mode.damping_ratio * mode.natural_frequency;
    for (int i = -120; i <= 120; ++i) {
      const double frequency = mode.natural_frequency + width * std::sinh(0.05 * i);
      if (frequency > 0.0 && frequency < top) grid.push_back(frequency);
    }
  }
  std::sort(grid.begin(), grid.end());
  return grid;
}

double wrapped_phase(double angle) { return std::remainder(angle, kTwoPi); }

struct Sample {
  double frequency;
  Pair eigenvalues;
};

// Over the immersion, which is the same at all frequencies. Altintas' coefficients are -2/k_tc times the integral of
// the cutting stiffness.
Eigen::Matrix2cd directional_coefficients(const LinearCut& cut) {
  const Eigen::Matrix2d alpha =
      -2.0 / cut.ktc * cutting_stiffness_integral(cut, cut.immersion.entry, cut.immersion.exit).topRows<2>();
  return alpha.cast<Complex>();
}

Pair eigenvalues_of(const Eigen::Matrix2cd& oriented) {
  const Complex half_trace = 0.5 * oriented.trace();
  const Complex root = std::sqrt(half_trace * half_trace - oriented.determinant());
  return {half_trace + root, half_trace - root};
}

// The oriented receptance's eigenvalues at a frequency, rad/s.
using Eigenvalues = std::function<Pair(double frequency)>;

// Refines the frequency between two samples at which branch `which` closes its phase at this tooth period.
struct Crossing {
  double frequency;
  LobeBranch branch;
};
Crossing refine(const LinearCut& cut, const Eigenvalues& eigenvalues, double period, int which, Sample low,
                Sample high) {
  const auto index = static_cast<std::size_t>(which);
  double gap_low = wrapped_phase(low.frequency * period - lobe_branch(cut, low.eigenvalues[index]).phase);
  Crossing crossing{low.frequency, lobe_branch(cut, low.eigenvalues[index])};
  for (int step = 0; step < 30; ++step) {
    Sample middle{0.5 * (low.frequency + high.frequency), {}};
    const Pair halfway{0.5 * (low.eigenvalues[0] + high.eigenvalues[0]),
                       0.5 * (low.eigenvalues[1] + high.eigenvalues[1])};
    middle.eigenvalues = continued(eigenvalues(middle.frequency), halfway);
    crossing = {middle.frequency, lobe_branch(cut, middle.eigenvalues[index])};
    const double gap = wrapped_phase(middle.frequency * period - crossing.branch.phase);
    if (gap == 0.0) break;
    if ((gap < 0.0) == (gap_low < 0.0)) {
      low = middle, gap_low = gap;
    } else {
      high = middle;
    }
  }
  return crossing;
}

}  // namespace

LobeBranch lobe_branch(const LinearCut& cut, Complex oriented_eigenvalue) {
  const Complex lambda = -1.0 / oriented_eigenvalue;
  const double ratio = lambda.imag() / lambda.real();
  const double depth = -kTwoPi * lambda.real() / (cut.teeth * cut.ktc) * (1.0 + ratio * ratio);
  const double phase = std::numbers::pi - 2.0 * std::atan2(lambda.imag(), lambda.real());
  return {depth, phase - kTwoPi * std::floor(phase / kTwoPi)};
}

Pair oriented_eigenvalues(const LinearCut& cut, const Eigen::Matrix2cd& receptance) {
  return eigenvalues_of(directional_coefficients(cut) * receptance);
}

Pair oriented_eigenvalues(const LinearCut& cut, std::span<const Mode> modes, double frequency) {
  return oriented_eigenvalues(cut, in_feed_plane(modes, frequency));
}

std::vector<DepthLimit> zeroth_order_limits(const LinearCut& cut, std::span<const Mode> modes,
                                            std::span<const double> speeds, double max_depth) {
  const auto of_modes = [&](double frequency) { return in_feed_plane(modes, frequency); };
  return zeroth_order_limits(cut, modes, of_modes, speeds, max_depth);
}

std::vector<DepthLimit> zeroth_order_limits(const LinearCut& cut, std::span<const Mode> modes,
                                            const FeedReceptance& receptance, std::span<const double> speeds,
                                            double max_depth) {
  check_modes(modes);
  if (!(max_depth > 0.0)) throw std::invalid_argument("largest depth: must be positive");
  double longest_period = 0.0;
  for (const double speed : speeds) {
    if (!(speed > 0.0) || !std::isfinite(speed)) throw std::invalid_argument("spindle speed: must be positive");
    longest_period = std::max(longest_period, kTwoPi / (speed * cut.teeth));
  }
  const Eigen::Matrix2cd alpha = directional_coefficients(cut);
  const Eigenvalues eigenvalues = [&](double frequency) { return eigenvalues_of(alpha * receptance(frequency)); };
  std::vector<Sample> samples;
  for (const double frequency : frequency_grid(modes, longest_period)) {
    const Pair pair = eigenvalues(frequency);
    samples.push_back({frequency, samples.empty() ? pair : continued(pair, samples.back().eigenvalues)});
  }
  std::vector<std::array<LobeBranch, 2>> branches;
  branches.reserve(samples.size());
  for (const Sample& sample : samples) {
    branches.push_back({lobe_branch(cut, sample.eigenvalues[0]), lobe_branch(cut, sample.eigenvalues[1])});
  }

  std::vector<DepthLimit> limits;
  for (const double speed : speeds) {
    const double period = kTwoPi / (speed * cut.teeth);
    DepthLimit limit{kInfinity, kNaN, Instability::hopf, 0.0};
    for (std::size_t i = 0; i + 1 < samples.size(); ++i) {
      for (std::size_t which = 0; which < 2; ++which) {
        const LobeBranch &a = branches[i][which], &b = branches[i + 1][which];
        if (!(a.depth > 0.0 || b.depth > 0.0) || std::min(a.depth, b.depth) > 2.0 * std::min(limit.depth, max_depth)) {
          continue;
        }
        const double gap_a = wrapped_phase(samples[i].frequency * period - a.phase);
        const double gap_b = wrapped_phase(samples[i + 1].frequency * period - b.phase);
        if ((gap_a < 0.0) == (gap_b < 0.0) || std::abs(gap_a - gap_b) > std::numbers::pi) continue;
        const Crossing crossing = refine(cut, eigenvalues, period, static_cast<int>(which), samples[i], samples[i + 1]);
        if (crossing.branch.depth > 0.0 && crossing.branch.depth < limit.depth) {
          limit.depth = crossing.branch.depth;
          limit.chatter_frequency = crossing.frequency;
        }
      }
    }
    if (limit.depth > max_depth) limit = {kInfinity, kNaN, Instability::hopf, 0.0};
    limits.push_back(limit);
  }
  return limits;
}

}  // namespace stillcut
