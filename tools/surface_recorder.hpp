// Watches a simulated cut for the surface that it leaves: an end mill's teeth as they pass the wall, a ball end's whole
// motion over the floor. Its roughness is `stillcut surface`'s, of profiles along the feed.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "models/floor_heights.hpp"
#include "models/machining.hpp"
#include "models/milled_profile.hpp"
#include "models/milling_simulation.hpp"
#include "models/wall_heights.hpp"

namespace stillcut {

class SurfaceRecorder {
 public:
  // For a simulation of samples `step` s apart. The cut's feed direction is that of the start, where the state's
  // spindle angle counts from.
  SurfaceRecorder(Tool tool, const Cut& cut, double step);

  // The simulation after each sample.
  void add(const MillingState& state, const MillingConditions& conditions);

  // "wall" or "floor".
  [[nodiscard]] const char* name() const { return of_floor() ? "floor" : "wall"; }
  // What was cut along the feed, m; from 0 to 0: nothing.
  [[nodiscard]] double begin() const;
  [[nodiscard]] double end() const;
  // How far into the part, m; NaN where not known.
  [[nodiscard]] std::vector<double> heights(double from, double spacing, std::size_t count) const;
  // All sampling lengths of a wall; of a floor, each of which takes some ten milliseconds and ten times that where the
  // tool swings by tenths of a millimetre, at most forty spread over it.
  [[nodiscard]] std::vector<MilledLength> lengths() const;

 private:
  [[nodiscard]] bool of_floor() const { return tool_.shape == ToolShape::ball; }
  void add_passes(const MillingState& state, const MillingConditions& conditions);
  void add_to_track(const MillingState& state, const MillingConditions& conditions);

  Tool tool_;
  Cut cut_;
  double start_direction_;            // rad
  double along_ = 0.0;                // m
  std::vector<std::int64_t> passes_;  // of each tooth so far
  std::vector<ToothPass> wall_;
  CutTrack track_;
};

}  // namespace stillcut
