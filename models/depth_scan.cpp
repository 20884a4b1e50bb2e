#include "models/depth_scan.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace stillcut {
namespace {

constexpr double kScanStep = 1.15;  // ratio of depths
constexpr double kScanTolerance = 1e-4;

// Golden-section search for a depth in (low, high) where the radius passes 1, though it is below at both ends.
std::optional<double> unstable_between(CutAtSpeed& cutting, double low, double high) {
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

// The radius may pass 1, come back and pass again within a bracket: the lowest quarter of it that ends unstable.
DepthBracket first_crossing(CutAtSpeed& cutting, const DepthBracket& bracket) {
  constexpr int kParts = 4;
  DepthBracket part = bracket;
  for (int i = 1; i < kParts; ++i) {
    part.high = bracket.low + (bracket.high - bracket.low) * i / kParts;
    if (cutting.radius(part.high, kScanTolerance) >= 1.0) return part;
    part.low = part.high;
  }
  part.high = bracket.high;
  return part;
}

}  // namespace

void check_max_depth(double max_depth) {
  if (!(max_depth > 0.0) || !std::isfinite(max_depth)) throw std::invalid_argument("largest depth: must be positive");
}

DepthScan scan_depths(CutAtSpeed& cutting, double max_depth) {
  constexpr double kLookCloser = 0.85;  // above this the radius may pass 1 between two steps and come back
  double depth = 2e-3 * max_depth, radius = cutting.radius(depth);
  DepthScan scan;
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
    const double next = cutting.radius(next_depth, kScanTolerance);
    if (next < 1.0 && std::max(radius, next) > kLookCloser) {
      // A peak at this depth, or a rise that would have passed 1 before the next one.
      const double promised = radius + (radius - before) * (next_depth - depth) / (depth - before_depth);
      const bool peak = radius > before && radius > next;
      if (peak || promised > 1.0) {
        const double from = peak ? before_depth : depth;
        if (const auto high = unstable_between(cutting, from, next_depth)) {
          scan.crossing = {from, *high, true};
          return scan;
        }
      }
    }
    if (next >= 1.0) {
      scan.crossing = radius > kLookCloser ? first_crossing(cutting, {depth, next_depth, true})
                                           : DepthBracket{depth, next_depth, true};
      return scan;
    }
    before_depth = depth, before = radius;
    depth = next_depth, radius = next;
  }
  scan.peak = std::max(scan.peak, radius);
  return scan;
}

std::optional<DepthCrossing> crossing_in(CutAtSpeed& cutting, const DepthBracket& bracket, double tolerance) {
  double low = bracket.low, high = bracket.high;
  double at_low = std::log(cutting.radius(low)), at_high = std::log(cutting.radius(high));
  if (!(at_low < 0.0 && at_high >= 0.0)) return std::nullopt;
  int side = 0;
  double depth = high;
  double first = high, at_first = at_high, second = low, at_second = at_low;  // the last two depths looked at
  for (int step = 0; step < 80; ++step) {
    const double last = depth;
    depth = (low * at_high - high * at_low) / (at_high - at_low);
    if (std::abs(depth - last) <= tolerance * depth || high - low <= tolerance * depth) break;
    const double value = std::log(cutting.radius(depth));
    second = first, at_second = at_first;
    first = depth, at_first = value;
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
  return DepthCrossing{depth, first == second ? 0.0 : (at_first - at_second) / (first - second)};
}

}  // namespace stillcut
