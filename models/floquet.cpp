#include "models/floquet.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <optional>
#include <stdexcept>

#include "models/period_map.hpp"

namespace stillcut {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kScanStep = 1.15;  // ratio of depths
constexpr int kFinestLevel = 8;

Collocation level(int index) { return {3.0 + 4.0 * index, 3.5 + 0.5 * index}; }

// The period map at one speed and resolution; straight teeth need it once, helical ones at every depth.
class Cutting {
 public:
  Cutting(const LinearCut& cut, std::span<const Mode> modes, double speed, int resolution)
      : cut_(cut), modes_(modes), speed_(speed), collocation_(level(resolution)) {}

  Eigen::MatrixXd monodromy(double depth) {
    if (!map_ || cut_.lag_per_depth > 0.0) map_ = period_map(cut_, modes_, speed_, depth, collocation_);
    return stillcut::monodromy(*map_, depth);
  }
  double radius(double depth) {
    return Eigen::EigenSolver<Eigen::MatrixXd>(monodromy(depth), false).eigenvalues().cwiseAbs().maxCoeff();
  }
  double period() const { return kTwoPi / (speed_ * cut_.teeth); }
  std::span<const Mode> modes() const { return modes_; }

 private:
  const LinearCut& cut_;
  std::span<const Mode> modes_;
  double speed_;
  Collocation collocation_;
  std::optional<PeriodMap> map_;
};

struct Bracket {
  double low = 0.0, high = 0.0;  // stable at low, unstable at high
  bool found = false;
};

// Golden-section search for a depth in (low, high) where the radius passes 1, though it is below at both ends.
std::optional<double> unstable_between(Cutting& cutting, double low, double high) {
  constexpr double kGolden = 0.6180339887498949;
  double a = high - kGolden * (high - low), b = low + kGolden * (high - low);
  double at_a = cutting.radius(a), at_b = cutting.radius(b);
  for (int step = 0; step < 10; ++step) {
    if (at_a >= 1.0) return a;
    if (at_b >= 1.0) return b;
    if (at_a > at_b) {
      high = b, b = a, at_b = at_a;
      a = high - kGolden * (high - low), at_a = cutting.radius(a);
    } else {
      low = a, a = b, at_a = at_b;
      b = low + kGolden * (high - low), at_b = cutting.radius(b);
    }
  }
  return std::nullopt;
}

struct Scan {
  Bracket crossing;
  double peak = 0.0;  // largest radius seen before the crossing
  bool always_unstable = false;
};

Scan scan_depths(Cutting& cutting, double max_depth) {
  constexpr double kLookCloser = 0.9;  // a peak of the radius above this may pass 1 between two steps
  double depth = 2e-3 * max_depth, radius = cutting.radius(depth);
  Scan scan;
  while (radius >= 1.0) {
    const double high = depth;
    depth *= 0.25;
    if (depth < 1e-9 * max_depth) return {{}, radius, true};
    radius = cutting.radius(depth);
    if (radius < 1.0) return {{depth, high, true}, radius, false};
  }
  double before_depth = 0.0, before = 0.0;
  while (depth < max_depth) {
    scan.peak = std::max(scan.peak, radius);
    const double next_depth = std::min(max_depth, kScanStep * depth);
    const double next = cutting.radius(next_depth);
    if (radius > kLookCloser && radius > before && radius > next) {
      if (const auto high = unstable_between(cutting, before_depth, next_depth)) {
        scan.crossing = {before_depth, *high, true};
        return scan;
      }
    }
    if (next >= 1.0) {
      scan.crossing = {depth, next_depth, true};
      return scan;
    }
    before_depth = depth, before = radius;
    depth = next_depth, radius = next;
  }
  scan.peak = std::max(scan.peak, radius);
  return scan;
}

// The depth in the bracket where log(radius) is 0, by the Illinois form of false position. Returns nothing when the
// bracket does not hold at this resolution.
std::optional<double> crossing_in(Cutting& cutting, Bracket bracket, double tolerance) {
  double low = bracket.low, high = bracket.high;
  double at_low = std::log(cutting.radius(low)), at_high = std::log(cutting.radius(high));
  if (!(at_low < 0.0 && at_high >= 0.0)) return std::nullopt;
  int side = 0;
  double depth = high;
  for (int step = 0; step < 80; ++step) {
    const double last = depth;
    depth = (low * at_high - high * at_low) / (at_high - at_low);
    if (std::abs(depth - last) <= tolerance * depth || high - low <= tolerance * depth) break;
    const double value = std::log(cutting.radius(depth));
    if (value < 0.0) {
      low = depth, at_low = value;
      if (side == -1) at_high *= 0.5;
      side = -1;
    } else {
      high = depth, at_high = value;
      if (side == +1) at_low *= 0.5;
      side = +1;
    }
  }
  return depth;
}

struct Leading {
  double radius, frequency;  // frequency in rad/s
  Instability instability;
};

// The leading multiplier, and the frequency it stands for. Multipliers tell frequencies only up to multiples of the
// tooth frequency; of these aliases the one nearest the dominant mode is meant, the mode that moves the tool most in
// the plane.
Leading leading_multiplier(Cutting& cutting, double depth) {
  const Eigen::EigenSolver<Eigen::MatrixXd> solver(cutting.monodromy(depth));
  Eigen::Index index;
  const double radius = solver.eigenvalues().cwiseAbs().maxCoeff(&index);
  const std::complex<double> multiplier = solver.eigenvalues()[index];
  const Eigen::VectorXcd vector = solver.eigenvectors().col(index);
  double strongest = -1.0, dominant = 0.0;
  for (std::size_t m = 0; m < cutting.modes().size(); ++m) {
    const Mode& mode = cutting.modes()[m];
    const double plane = std::hypot(mode.direction[0], mode.direction[1]);
    const double amplitude = plane * vector.segment(2 * static_cast<Eigen::Index>(m), 2).norm();
    if (amplitude > strongest) strongest = amplitude, dominant = mode.natural_frequency;
  }
  const double angle = std::abs(std::arg(multiplier)), turn = dominant * cutting.period();
  const double above = angle + kTwoPi * std::round((turn - angle) / kTwoPi);
  const double below = -angle + kTwoPi * std::round((turn + angle) / kTwoPi);
  const double alias = std::abs(above - turn) <= std::abs(below - turn) ? above : below;
  constexpr double kReal = 1e-7;
  const auto kind = angle < kReal                      ? Instability::fold
                    : std::numbers::pi - angle < kReal ? Instability::flip
                                                       : Instability::hopf;
  return {radius, std::abs(alias) / cutting.period(), kind};
}

}  // namespace

FloquetPoint floquet_point(const LinearCut& cut, std::span<const Mode> modes, double speed, double depth) {
  constexpr double kTolerance = 1e-7;
  double previous = Cutting(cut, modes, speed, 1).radius(depth);
  for (int resolution = 2;; ++resolution) {
    Cutting cutting(cut, modes, speed, resolution);
    const Leading leading = leading_multiplier(cutting, depth);
    const double change = std::abs(leading.radius - previous);
    if (change <= kTolerance * std::max(1.0, leading.radius) || resolution == kFinestLevel) {
      return {leading.radius, leading.frequency, leading.instability, cutting.period(), change};
    }
    previous = leading.radius;
  }
}

DepthLimit floquet_depth_limit(const LinearCut& cut, std::span<const Mode> modes, double speed,
                               const DepthSearch& search) {
  if (!(search.max_depth > 0.0) || !std::isfinite(search.max_depth)) {
    throw std::invalid_argument("largest depth: must be positive");
  }
  if (!(search.tolerance > 0.0)) throw std::invalid_argument("tolerance: must be positive");
  constexpr double kNearlyUnstable = 0.99;  // a scan this near 1 is repeated at a finer level before it says "stable"
  constexpr double kLevelsAgree = 1e-2;     // neighbouring levels are expected to agree this well
  constexpr double kFineTolerance = 1e-2;   // of the wanted tolerance, for the root at one level
  Bracket bracket;
  double previous = kNaN;
  for (int resolution = 0; resolution <= kFinestLevel; ++resolution) {
    Cutting cutting(cut, modes, speed, resolution);
    if (!bracket.found) {
      const Scan scan = scan_depths(cutting, search.max_depth);
      if (scan.always_unstable) return {kNaN, kNaN, Instability::hopf, 0.0};
      if (!scan.crossing.found && (resolution > 1 || scan.peak < kNearlyUnstable)) {
        return {kInfinity, kNaN, Instability::hopf, 0.0};
      }
      bracket = scan.crossing;
      continue;
    }
    const auto depth = crossing_in(cutting, bracket, kFineTolerance * search.tolerance);
    if (!depth) {
      bracket.found = false;  // the coarser level was wrong here: scan again at the next
      previous = kNaN;
      continue;
    }
    const double change = std::abs(*depth - previous) / *depth;
    if (change <= search.tolerance || resolution == kFinestLevel) {
      const Leading leading = leading_multiplier(cutting, *depth);
      return {*depth, leading.frequency, leading.instability, change};
    }
    previous = *depth;
    bracket.low = std::max(bracket.low, *depth * (1.0 - kLevelsAgree));
    bracket.high = std::min(bracket.high, *depth * (1.0 + kLevelsAgree));
  }
  return {kInfinity, kNaN, Instability::hopf, 0.0};
}

}  // namespace stillcut
