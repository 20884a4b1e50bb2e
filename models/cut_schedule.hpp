// A cut whose depth and spindle speed change as planned: what a simulation is told from sample to sample.
#pragma once

#include "models/milling_simulation.hpp"
#include "models/schedule.hpp"

namespace stillcut {

struct CutSchedule {
  Schedule axial_depth;    // m; empty: the cut's own. 0: the tool is out of the part
  Schedule spindle_speed;  // rad/s; empty: the cut's own. Feed per tooth is kept
};

// Makes the setup begin where the schedule does, with the range that the schedule needs. Throws std::invalid_argument
// for times that go back, numbers that are not finite and values out of range.
[[nodiscard]] MillingSetup scheduled(MillingSetup setup, const CutSchedule& schedule);

[[nodiscard]] MillingConditions conditions_at(const MillingSetup& setup, const CutSchedule& schedule, double time);

}  // namespace stillcut
