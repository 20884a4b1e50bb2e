#include "models/floquet.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <stdexcept>

#include "dsp/numbers.hpp"
#include "models/depth_scan.hpp"

namespace stillcut {

Collocation resolution(int level) {
  constexpr std::array<Collocation, kFinestLevel + 1> kLevels{
      {{4.0, 3.0, 1.5}, {6.0, 4.0, 1.5}, {9.0, 5.0, 1.5}, {13.0, 6.0, 1.5}, {19.0, 8.0, 1.5}}};
  return kLevels.at(static_cast<std::size_t>(level));
}

CutAtSpeed::CutAtSpeed(const LinearCut& cut, std::span<const Mode> modes, double speed, int level)
    : cut_(cut), modes_(modes), speed_(speed), collocation_(resolution(level)) {}

void CutAtSpeed::move_to(double speed) {
  speed_ = speed;
  map_.reset();
}

LeadingMultiplier CutAtSpeed::solve(double depth, double tolerance) {
  constexpr double kRoom = 1.4, kTooFine = 8.0;  // a map serves depths below its own, at a price
  const bool fits =
      map_ && (depends_on_depth(cut_) ? depth == map_depth_ : depth <= map_depth_ && depth * kTooFine > map_depth_);
  if (!fits) {
    map_depth_ = depends_on_depth(cut_) ? depth : kRoom * depth;
    map_ = period_map(cut_, modes_, speed_, depth, map_depth_, collocation_);
  }
  constexpr int kFew = 4;
  const int least = 2 * static_cast<int>(modes_.size()) + kFew;
  if (!cut_.pitch.empty()) {
    return arnoldi_.leading(SeveralDelaysOperator(cut_, modes_, *map_, speed_, depth), 2 * least, tolerance);
  }
  operator_.set(*map_, depth);
  return arnoldi_.leading(operator_, least, tolerance);
}

double CutAtSpeed::radius(double depth, double tolerance) { return std::abs(solve(depth, tolerance).value); }

// Multipliers tell frequencies only up to multiples of the period's frequency; of these aliases the one nearest the
// dominant mode is meant, the mode that moves the tool most where it cuts.
CutAtSpeed::Multiplier CutAtSpeed::leading(double depth, double tolerance) {
  const std::complex<double> multiplier = solve(depth, tolerance).value;
  const auto vector = arnoldi_.eigenvector(2 * static_cast<int>(modes_.size()));
  double strongest = -1.0, dominant = 0.0;
  for (std::size_t m = 0; m < modes_.size(); ++m) {
    const auto& u = modes_[m].direction;
    const double seen = std::hypot(u[0], u[1], cut_.shape == ToolShape::ball ? u[2] : 0.0);
    const double amplitude = seen * std::sqrt(std::norm(vector[2 * m]) + std::norm(vector[2 * m + 1]));
    if (amplitude > strongest) strongest = amplitude, dominant = modes_[m].natural_frequency;
  }
  const double angle = std::abs(std::arg(multiplier)), turn = dominant * period();
  const double above = angle + kTwoPi * std::round((turn - angle) / kTwoPi);
  const double below = -angle + kTwoPi * std::round((turn + angle) / kTwoPi);
  const double alias = std::abs(above - turn) <= std::abs(below - turn) ? above : below;
  constexpr double kReal = 1e-7;
  const auto kind = angle < kReal                      ? Instability::fold
                    : std::numbers::pi - angle < kReal ? Instability::flip
                                                       : Instability::hopf;
  return {multiplier, std::abs(alias) / period(), kind};
}

FloquetPoint floquet_point(const LinearCut& cut, std::span<const Mode> modes, double speed, double depth) {
  constexpr double kTolerance = 1e-7;
  double previous = CutAtSpeed(cut, modes, speed, 0).radius(depth);
  for (int level = 1;; ++level) {
    CutAtSpeed cutting(cut, modes, speed, level);
    const CutAtSpeed::Multiplier leading = cutting.leading(depth);
    const double radius = std::abs(leading.value), change = std::abs(radius - previous);
    if (change <= kTolerance * std::max(1.0, radius) || level == kFinestLevel) {
      return {radius, leading.frequency, leading.instability, cutting.period(), change};
    }
    previous = radius;
  }
}

DepthLimit floquet_depth_limit(const LinearCut& cut, std::span<const Mode> modes, double speed,
                               const DepthSearch& search) {
  check_max_depth(search.max_depth);
  if (!(search.tolerance > 0.0)) throw std::invalid_argument("tolerance: must be positive");
  constexpr double kNearlyUnstable = 0.99;  // a scan this near 1 is repeated at a finer level before it says "stable"
  constexpr double kFineTolerance = 1e-2;   // of the wanted tolerance, for the root at one level
  for (int level = 0; level < kFinestLevel; ++level) {
    CutAtSpeed cutting(cut, modes, speed, level);
    const DepthScan scan = scan_depths(cutting, search.max_depth);
    if (scan.always_unstable) return {kNaN, kNaN, Instability::hopf, 0.0};
    if (!scan.crossing.found) {
      if (level > 0 || scan.peak < kNearlyUnstable) break;
      continue;
    }
    CutAtSpeed finer(cut, modes, speed, level + 1);
    const auto crossing = crossing_in(finer, scan.crossing, kFineTolerance * search.tolerance);
    if (!crossing) continue;  // the scan's level was too coarse here
    // How far the limit would move at the resolution after that, from the slope at the crossing.
    const CutAtSpeed::Multiplier leading =
        CutAtSpeed(cut, modes, speed, std::min(level + 2, kFinestLevel)).leading(crossing->depth);
    const double change = std::abs(std::log(std::abs(leading.value)) / (crossing->slope * crossing->depth));
    if (change <= search.tolerance || level + 1 == kFinestLevel) {
      return {crossing->depth, leading.frequency, leading.instability, change};
    }
  }
  return {kInfinity, kNaN, Instability::hopf, 0.0};
}

}  // namespace stillcut
