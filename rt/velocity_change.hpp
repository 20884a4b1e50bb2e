// The velocity interface of an axis among others: to a given velocity and acceleration, wherever the position then is.
// As in extremal_moves.hpp, but what lies between two extremes is the gain in velocity: largest with the acceleration
// up to a peak and down, least with the mirror image. An ExtremalMove whose trough is its end describes each.
//
// Divided by the jerk limit. Pure functions, noexcept, allocate nothing.
#pragma once

#include <optional>

#include "rt/extremal_moves.hpp"
#include "rt/stretched_move.hpp"

namespace stillcut {

// Of `move`, the distance and the limits of velocity do not count. The start must be inside the limits of acceleration.
[[nodiscard]] ExtremalMove fastest_change(const AxisMove& move) noexcept;

// The change in exactly this time; nothing if there is none.
[[nodiscard]] std::optional<StretchedMove> change_of_duration(const AxisMove& move, double duration) noexcept;

// The least duration above this impossible one, which is above the least of all, in which the change can be made.
[[nodiscard]] double next_possible_change(const AxisMove& move, double duration) noexcept;

}  // namespace stillcut
