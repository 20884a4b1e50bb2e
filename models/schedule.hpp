// A quantity over time, told by a few points with straight lines between them: depth of cut or spindle speed in a
// simulated cut. Before the first point its value holds, after the last point that one's.
#pragma once

#include <vector>

namespace stillcut {

struct SchedulePoint {
  double time = 0.0;   // s
  double value = 0.0;  // SI
};

using Schedule = std::vector<SchedulePoint>;  // rising time (two points at one time make a step); at least one point

[[nodiscard]] inline double value_at(const Schedule& schedule, double time) {
  if (time < schedule.front().time) return schedule.front().value;
  for (std::size_t i = 1; i < schedule.size(); ++i) {
    const auto& [t0, v0] = schedule[i - 1];
    const auto& [t1, v1] = schedule[i];
    if (time < t1) return v0 + (v1 - v0) * (time - t0) / (t1 - t0);
  }
  return schedule.back().value;
}

}  // namespace stillcut
