// Random cells, predictions and chatter for the tests of what a correction chooses; what the header of the limits says,
// once more in the plainest words.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <vector>

#include "dsp/numbers.hpp"
#include "rt/compensation_limits.hpp"
#include "rt/predicted_margin.hpp"

namespace stillcut {

class ChoiceCases {
 public:
  explicit ChoiceCases(std::uint64_t seed) : random_{seed} {}

  double between(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  bool chance(double share) { return between(0.0, 1.0) < share; }
  int whole(int low, int high) { return std::uniform_int_distribution<int>(low, high)(random_); }

  CompensationLimits limits() {
    CompensationLimits l;
    l.spindle = {rpm_to_rad_s(between(1000, 10000)), 0.0, rpm_to_rad_s(between(300, 6000)),
                 rpm_to_rad_s(between(3000, 60000))};
    l.spindle.max_speed = l.spindle.min_speed * between(1.0, 3.0);
    l.avoided_count = chance(0.5) ? 0 : static_cast<std::size_t>(whole(1, 3));
    for (std::size_t i = 0; i < l.avoided_count; ++i) {
      const double middle = between(l.spindle.min_speed, l.spindle.max_speed);
      l.avoided[i] = {middle * between(0.9, 1.0), middle * between(1.0, 1.1)};
    }
    l.feed_per_tooth = chance(0.3) ? 0.0 : between(0.03e-3, 0.2e-3);
    if (chance(0.7)) {
      l.min_feed_per_tooth = between(0.02e-3, 0.08e-3);
      l.max_feed_per_tooth = between(0.08e-3, 0.25e-3);
    }
    l.min_feed_override = between(0.3, 1.0);
    l.max_feed_override = between(1.0, 2.0);
    return l;
  }

  double speed_in(const CompensationLimits& l) { return between(l.spindle.min_speed, l.spindle.max_speed); }

  // Stable and unstable stretches of random width about a depth of 1 mm, now and then stable or unstable at every
  // depth; sometimes of less than the spindle's range.
  LobeDiagram diagram(const SpindleLimits& spindle) {
    LobeDiagram d;
    d.valid = true;
    d.point_count = whole(20, LobeDiagram::kMaxPoints);
    const double first = spindle.min_speed * (chance(0.2) ? 1.1 : 1.0);
    const double last = std::max(spindle.max_speed, first * 1.01);
    double held = between(0.2e-3, 2e-3), frequency_hz = between(50, 1500);
    for (int i = 0; i < d.point_count; ++i) {
      if (chance(0.15)) held = between(0.2e-3, 2e-3), frequency_hz = between(50, 1500);
      const double special = between(0.0, 1.0);
      const double limit = special < 0.02 ? kInfinity : special < 0.04 ? kNaN : held;
      d.points[static_cast<std::size_t>(i)] = {first + (last - first) * i / (d.point_count - 1), limit,
                                               std::isfinite(limit) ? frequency_hz : kNaN};
    }
    d.mode_count = whole(0, 4);
    for (int m = 0; m < d.mode_count; ++m)
      d.modes[static_cast<std::size_t>(m)] = {between(20, 2000), between(0.005, 0.1)};
    if (chance(0.5)) d.speed_scatter = between(0.0, 0.04), d.depth_scatter = between(0.0, 0.4);
    d.direction_count = whole(0, LobeDiagram::kMaxDirections);
    d.direction_speed = between(spindle.min_speed, spindle.max_speed);
    for (int i = 0; i < d.direction_count; ++i) {
      d.directions[static_cast<std::size_t>(i)] = {std::numbers::pi * i / d.direction_count,
                                                   chance(0.1) ? kNaN : between(0.2e-3, 2e-3)};
    }
    return d;
  }

 private:
  std::mt19937_64 random_;
};

// Diagrams that a prediction points to, kept with it.
struct KeptPrediction {
  std::optional<LobeDiagram> here, ahead;
  double axial_depth = 1e-3;

  [[nodiscard]] Prediction view() const { return {here ? &*here : nullptr, ahead ? &*ahead : nullptr, axial_depth}; }
};

inline KeptPrediction random_prediction(ChoiceCases& cases, const SpindleLimits& spindle) {
  KeptPrediction p;
  if (cases.chance(0.8)) p.here = cases.diagram(spindle);
  if (cases.chance(0.3)) p.ahead = cases.diagram(spindle);
  if (cases.chance(0.1)) p.axial_depth = kNaN;
  return p;
}

// Inside the spindle's range and outside every band that is to be avoided.
inline bool spindle_may_stay(const CompensationLimits& l, double speed) {
  bool may = speed >= l.spindle.min_speed && speed <= l.spindle.max_speed;
  for (std::size_t i = 0; i < l.avoided_count; ++i)
    may = may && (speed <= l.avoided[i].low || speed >= l.avoided[i].high);
  return may;
}

// Feed and speed go up and down together as far as the override goes; what a tooth then takes is in the window, if the
// program's own feed is.
inline bool tooth_may_take(const CompensationLimits& l, double speed, double programmed_speed) {
  const double f = l.feed_per_tooth;
  if (f == 0.0 || f < l.min_feed_per_tooth || f > l.max_feed_per_tooth) return true;
  double override_there = speed / programmed_speed;
  if (override_there > l.max_feed_override) override_there = l.max_feed_override;
  if (override_there < l.min_feed_override) override_there = l.min_feed_override;
  const double feed = f * override_there / (speed / programmed_speed);
  return feed > l.min_feed_per_tooth * (1.0 - 1e-8) && feed < l.max_feed_per_tooth * (1.0 + 1e-8);
}

}  // namespace stillcut
