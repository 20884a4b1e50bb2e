// Limits over the feed direction at every posture of a map, by Stillcut's own methods.
#pragma once

#include <functional>
#include <vector>

#include "drivers/files/cell.hpp"
#include "models/direction_limits.hpp"
#include "models/dynamics_map.hpp"
#include "tests/case_study/pattern_table.hpp"

namespace stillcut::case_study {

// 0 to 90 degrees for the paper's projection, beyond which it turns receptances negative; 0 to 175 for a tensor, which
// is the same again after half a turn.
std::vector<double> directions_of(DirectionMethod method, double step_deg = 5.0);

PlateLimits plate_limits(const Cell& cell, const DynamicsMap& map, DirectionMethod method,
                         const std::vector<double>& directions_deg, int speeds, int jobs,
                         const std::function<void(double)>& progress);

}  // namespace stillcut::case_study
