// Watches the teeth of a simulated cut pass the wall that they leave, for its roughness.
#pragma once

#include <cstdint>
#include <vector>

#include "models/machining.hpp"
#include "models/milling_simulation.hpp"
#include "models/wall_roughness.hpp"

namespace stillcut {

class WallRecorder {
 public:
  // The feed direction is that of the start, where the state's spindle angle counts from.
  WallRecorder(Tool tool, double feed_direction);

  // The simulation after each sample of `step` s.
  void add(const MillingState& state, const MillingConditions& conditions, double step);

  [[nodiscard]] double roughness() const;  // m; NaN: none was cut
  [[nodiscard]] const std::vector<ToothPass>& passes() const { return wall_; }

 private:
  Tool tool_;
  double start_direction_;            // rad
  double along_ = 0.0;                // m
  std::vector<std::int64_t> passes_;  // of each tooth so far
  std::vector<ToothPass> wall_;
};

}  // namespace stillcut
