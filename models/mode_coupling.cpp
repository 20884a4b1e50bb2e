#include "models/mode_coupling.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <stdexcept>
#include <vector>

#include "dsp/numbers.hpp"
#include "models/eigenvalues.hpp"
#include "models/receptance.hpp"

namespace stillcut {
namespace {

using Complex = std::complex<double>;

Eigen::Vector3d unit_direction(const Mode& mode) { return Eigen::Vector3d(mode.direction.data()).normalized(); }

void check(std::span<const Mode> modes, double max_depth, double highest_frequency) {
  check_modes(modes);
  if (!(max_depth > 0.0) || !std::isfinite(max_depth)) {
    throw std::invalid_argument("largest depth: must be positive");
  }
  if (!(highest_frequency > 0.0)) throw std::invalid_argument("highest frequency: must be positive");
}

// The displacement in the plane that a displacement of the plane brings forth through the cut, per depth: G W, 2 x 2,
// as a function of frequency.
class CutResponse {
 public:
  CutResponse(const LinearCut& cut, std::span<const Mode> modes) : modes_{modes} {
    const DirectionMatrix stiffness = mean_cutting_stiffness(cut);
    for (const Mode& mode : modes) {
      const Eigen::Vector3d u = unit_direction(mode);
      compliance_.emplace_back(u.head<2>() * (u.transpose() * stiffness) / mode.stiffness);
    }
  }

  // Its two eigenvalues; the first is the one nearer to the first of `before`.
  [[nodiscard]] std::array<Complex, 2> eigenvalues(double frequency, const std::array<Complex, 2>& before) const {
    Eigen::Matrix2cd sum = Eigen::Matrix2cd::Zero();
    for (std::size_t r = 0; r < modes_.size(); ++r) {
      const double ratio = frequency / modes_[r].natural_frequency;
      sum += compliance_[r] / Complex(1.0 - ratio * ratio, 2.0 * modes_[r].damping_ratio * ratio);
    }
    const Complex mean = 0.5 * sum.trace(), spread = std::sqrt(mean * mean - sum.determinant());
    const std::array<Complex, 2> found{mean + spread, mean - spread};
    const double kept = std::abs(found[0] - before[0]) + std::abs(found[1] - before[1]);
    const double swapped = std::abs(found[1] - before[0]) + std::abs(found[0] - before[1]);
    return kept <= swapped ? found : std::array{found[1], found[0]};
  }

 private:
  std::span<const Mode> modes_;
  std::vector<Eigen::Matrix2d> compliance_;
};

// M^-1 P with P_rs = u_r . W u_s: how displaced modes push each other through the cut, per depth.
Eigen::MatrixXd modal_coupling(const LinearCut& cut, std::span<const Mode> modes) {
  const DirectionMatrix stiffness = mean_cutting_stiffness(cut);
  const auto count = static_cast<Eigen::Index>(modes.size());
  Eigen::MatrixXd result(count, count);
  for (Eigen::Index r = 0; r < count; ++r) {
    const Mode& pushed = modes[static_cast<std::size_t>(r)];
    const Eigen::RowVector2d force = unit_direction(pushed).transpose() * stiffness;
    const double inverse_mass = pushed.natural_frequency * pushed.natural_frequency / pushed.stiffness;
    for (Eigen::Index s = 0; s < count; ++s) {
      result(r, s) = inverse_mass * force.dot(unit_direction(modes[static_cast<std::size_t>(s)]).head<2>());
    }
  }
  return result;
}

// Frequencies at which the response is looked at: dense where a mode resonates, up to where the cut's stiffness can
// carry a frequency.
std::vector<double> coupling_frequencies(std::span<const Mode> modes, double highest_added) {
  constexpr double kRatio = 1.005, kSteps = 0.1, kReach = 7.0;
  double lowest = kInfinity, highest = 0.0;
  std::vector<double> grid;
  for (const Mode& mode : modes) {
    lowest = std::min(lowest, mode.natural_frequency);
    highest = std::max(highest, mode.natural_frequency);
    for (double step = -kReach; step <= kReach; step += kSteps) {
      grid.push_back(mode.natural_frequency * (1.0 + mode.damping_ratio * std::sinh(step)));
    }
  }
  highest = 1.1 * std::sqrt(highest * highest + highest_added);
  for (double frequency = 1e-3 * lowest; frequency <= highest; frequency *= kRatio) grid.push_back(frequency);
  std::erase_if(grid, [&](double frequency) { return !(frequency > 0.0 && frequency <= highest); });
  std::sort(grid.begin(), grid.end());
  return grid;
}

// The frequency between two of the grid's at which one eigenvalue is real, and its value there.
struct RealEigenvalue {
  double frequency;
  Complex value;
};
RealEigenvalue real_eigenvalue(const CutResponse& response, double low, double high, std::array<Complex, 2> at_low,
                               std::size_t branch) {
  constexpr double kResolution = 1e-13;
  while (high - low > kResolution * high) {
    const double middle = 0.5 * (low + high);
    const auto at_middle = response.eigenvalues(middle, at_low);
    if (at_middle.at(branch).imag() * at_low.at(branch).imag() > 0.0) {
      low = middle, at_low = at_middle;
    } else {
      high = middle;
    }
  }
  return {low, at_low.at(branch)};
}

// The least frequency of a complex or negative eigenvalue (0: negative), or NaN when all that are slow enough are real
// and positive.
double coupled_frequency(const Eigen::VectorXcd& eigenvalues, double highest_frequency) {
  constexpr double kReal = 1e-7;  // relative: rounding parts equal eigenvalues by the root of its own size
  double frequency = kNaN;
  for (const Complex& value : eigenvalues) {
    if (std::abs(value.imag()) <= kReal * std::abs(value) && value.real() > 0.0) continue;
    const double found = std::sqrt(std::max(0.0, value.real()));
    if (found <= highest_frequency) frequency = std::fmin(frequency, found);
  }
  return frequency;
}

}  // namespace

DirectionMatrix mean_cutting_stiffness(const LinearCut& cut) {
  return cut.teeth / kTwoPi * cutting_stiffness_integral(cut, cut.immersion.entry, cut.immersion.exit);
}

ModeCouplingLimit mode_coupling_limit(const LinearCut& cut, std::span<const Mode> modes, double max_depth,
                                      double highest_frequency) {
  check(modes, max_depth, highest_frequency);
  const CutResponse response(cut, modes);
  ModeCouplingLimit limit{kInfinity, kNaN};
  // At the limit an eigenvalue of G W is real, and it is -1/a.
  const auto consider = [&](double frequency, Complex eigenvalue) {
    constexpr double kReal = 1e-6;  // relative: what is not real is no crossing, but two branches taken for each other
    if (frequency > highest_frequency || !(eigenvalue.real() < 0.0) ||
        std::abs(eigenvalue.imag()) > kReal * std::abs(eigenvalue))
      return;
    const double depth = -1.0 / eigenvalue.real();
    if (depth <= max_depth && depth < limit.depth) limit = {depth, frequency};
  };
  std::array<Complex, 2> before = response.eigenvalues(0.0, {});
  for (const Complex& eigenvalue : before) consider(0.0, eigenvalue);
  double last = 0.0;
  for (const double frequency : coupling_frequencies(modes, max_depth * modal_coupling(cut, modes).norm())) {
    const auto now = response.eigenvalues(frequency, before);
    for (std::size_t branch = 0; branch < now.size(); ++branch) {
      if (before.at(branch).imag() * now.at(branch).imag() >= 0.0) continue;
      const RealEigenvalue crossing = real_eigenvalue(response, last, frequency, before, branch);
      consider(crossing.frequency, crossing.value);
    }
    before = now;
    last = frequency;
  }
  return limit;
}

ModeCouplingLimit undamped_mode_coupling_limit(const LinearCut& cut, std::span<const Mode> modes, double max_depth,
                                               double highest_frequency) {
  check(modes, max_depth, highest_frequency);
  constexpr double kFirst = 1e-3, kStep = 1.03, kShallowest = 1e-5, kTolerance = 1e-6;
  const Eigen::MatrixXd coupling = modal_coupling(cut, modes);
  Eigen::VectorXd squares(coupling.rows());
  std::transform(modes.begin(), modes.end(), squares.begin(),
                 [](const Mode& mode) { return mode.natural_frequency * mode.natural_frequency; });
  const auto frequency_at = [&](double depth) {
    Eigen::MatrixXd matrix = depth * coupling;
    matrix.diagonal() += squares;
    return coupled_frequency(eigenvalues(matrix), highest_frequency);
  };
  double low = 0.0, high = kFirst * max_depth;
  double frequency = frequency_at(high);
  while (!std::isnan(frequency) && low == 0.0) {  // unstable at once: look at shallower depths
    const double shallower = 0.25 * high;
    if (shallower < kShallowest * max_depth) return {kNaN, kNaN};
    if (std::isnan(frequency_at(shallower))) {
      low = shallower;
    } else {
      high = shallower;
    }
  }
  while (std::isnan(frequency)) {
    if (high >= max_depth) return {kInfinity, kNaN};
    low = high;
    high = std::min(max_depth, kStep * high);
    frequency = frequency_at(high);
  }
  while (high - low > kTolerance * high) {
    const double middle = 0.5 * (low + high);
    (std::isnan(frequency_at(middle)) ? low : high) = middle;
  }
  return {high, frequency_at(high)};
}

}  // namespace stillcut
