#include "models/lobe_trace.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "dsp/numbers.hpp"
#include "models/depth_scan.hpp"

namespace stillcut {
namespace {

constexpr double kBeyond = 1.5;  // limits are followed up to this times the largest depth
constexpr double kLookTolerance = 1e-5;

// A limit while it is followed: in the logarithm of the depth, where lobes are smoother.
struct Followed {
  double log_depth = 0.0;
  double slope = 0.0;  // of log radius over log depth
};

// Newton's way to the crossing, with slopes from the last two depths. Nothing when it does not lead there.
std::optional<Followed> follow(CutAtSpeed& cutting, double guess, double slope, double tolerance) {
  constexpr int kMostSteps = 8;
  constexpr double kLongestStep = 0.25;
  double x = guess, value = std::log(cutting.radius(std::exp(x), kLookTolerance));
  for (int step = 0; step < kMostSteps; ++step) {
    if (!(slope > 0.0)) return std::nullopt;
    const double move = std::clamp(-value / slope, -kLongestStep, kLongestStep);
    if (std::abs(move) <= tolerance) return Followed{x + move, slope};
    const double next = x + move, next_value = std::log(cutting.radius(std::exp(next), kLookTolerance));
    slope = (next_value - value) / move;
    x = next, value = next_value;
  }
  return std::nullopt;
}

class Trace {
 public:
  Trace(const LinearCut& cut, std::span<const Mode> modes, std::span<const double> speeds,
        const TraceSettings& settings)
      : speeds_(speeds),
        settings_(settings),
        cutting_(cut, modes, speeds.front(), settings.level),
        limits_(speeds.size()),
        followed_(speeds.size()) {}

  std::vector<DepthLimit> run() {
    for (std::size_t i = 0; i < speeds_.size(); ++i) {
      cutting_.move_to(speeds_[i]);
      if (!step(i)) search_back_from(i);
    }
    return std::move(limits_);
  }

 private:
  // Follows the boundary to speed i; false where it has to be searched for.
  bool step(std::size_t i) {
    if (i == 0) return false;
    if (!followed_[i - 1]) return std::isinf(limits_[i - 1].depth) && still_stable(i);
    const auto found = follow(cutting_, promised(i), followed_[i - 1]->slope, settings_.tolerance);
    if (!found || found->log_depth > std::log(kBeyond * settings_.max_depth)) return false;
    // Islands below: two looks a speed, at depths that change from speed to speed.
    constexpr std::array<double, 6> kLooks{0.93, 0.45, 0.8, 0.3, 0.65, 0.15};
    const double depth = std::exp(found->log_depth);
    for (const std::size_t look : {2 * i, 2 * i + 1}) {
      if (cutting_.radius(kLooks[look % kLooks.size()] * depth, kLookTolerance) >= 1.0) return false;
    }
    keep(i, *found);
    return true;
  }

  // Where no limit was: a few looks over all depths, at depths that change from speed to speed.
  bool still_stable(std::size_t i) {
    constexpr double kRatio = 0.75, kLowest = 0.05, kNearlyUnstable = 0.97;
    constexpr std::size_t kShifts = 4;
    if (cutting_.radius(settings_.max_depth, kLookTolerance) > kNearlyUnstable) return false;
    const double shift = std::pow(kRatio, static_cast<double>(1 + i % kShifts) / kShifts);
    for (double depth = shift * settings_.max_depth; depth > kLowest * settings_.max_depth; depth *= kRatio) {
      if (cutting_.radius(depth, kLookTolerance) > kNearlyUnstable) return false;
    }
    followed_[i].reset();
    limits_[i] = {kInfinity, kNaN, Instability::hopf, 0.0};
    return true;
  }

  // Straight on from the last two limits.
  [[nodiscard]] double promised(std::size_t i) const {
    const double last = followed_[i - 1]->log_depth;
    if (i < 2 || !followed_[i - 2]) return last;
    constexpr double kLargestStep = 0.15;
    double change = last - followed_[i - 2]->log_depth;
    if (i > 2 && followed_[i - 3]) change += change - (followed_[i - 2]->log_depth - followed_[i - 3]->log_depth);
    return last + std::clamp(change, -kLargestStep, kLargestStep);
  }

  // Searches speed i in full, and the speeds before it as long as that changes them.
  void search_back_from(std::size_t i) {
    constexpr double kSame = 0.02;
    search(i);
    for (std::size_t k = i; k > 0 && followed_[k - 1]; --k) {
      const double before = followed_[k - 1]->log_depth;
      const double gap = followed_[k] ? std::abs(followed_[k]->log_depth - before) : kInfinity;
      if (gap < 10.0 * kSame) break;  // the boundary goes on: nothing began here
      cutting_.move_to(speeds_[k - 1]);
      search(k - 1);
      if (followed_[k - 1] && std::abs(followed_[k - 1]->log_depth - before) < kSame) break;
    }
  }

  void search(std::size_t i) {
    followed_[i].reset();
    limits_[i] = {kInfinity, kNaN, Instability::hopf, 0.0};
    const DepthScan scan = scan_depths(cutting_, settings_.max_depth);
    if (scan.always_unstable) limits_[i].depth = kNaN;
    if (!scan.crossing.found) return;
    const auto crossing = crossing_in(cutting_, scan.crossing, settings_.tolerance);
    if (crossing) keep(i, {std::log(crossing->depth), crossing->slope * crossing->depth});
  }

  void keep(std::size_t i, const Followed& followed) {
    followed_[i] = followed;
    const double depth = std::exp(followed.log_depth);
    if (depth > settings_.max_depth) {
      limits_[i] = {kInfinity, kNaN, Instability::hopf, 0.0};
      return;
    }
    const CutAtSpeed::Multiplier leading = cutting_.leading(depth, kLookTolerance);
    limits_[i] = {depth, leading.frequency, leading.instability,
                  std::abs(std::log(std::abs(leading.value)) / followed.slope)};
  }

  std::span<const double> speeds_;
  TraceSettings settings_;
  CutAtSpeed cutting_;
  std::vector<DepthLimit> limits_;
  std::vector<std::optional<Followed>> followed_;
};

}  // namespace

std::vector<DepthLimit> traced_depth_limits(const LinearCut& cut, std::span<const Mode> modes,
                                            std::span<const double> speeds, const TraceSettings& settings) {
  check_max_depth(settings.max_depth);
  if (speeds.empty()) return {};
  return Trace(cut, modes, speeds, settings).run();
}

}  // namespace stillcut
