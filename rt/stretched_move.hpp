// A move that takes a given time, for axes that are to arrive together. The farthest and the least far move of that
// duration bracket the distance; their mixture in the right proportion covers it exactly and keeps every limit, as the
// limits are convex: jerk = share * farthest + (1 - share) * least far.
//
// Divided by the jerk limit, as in extremal_moves.hpp. Pure functions, noexcept, allocate nothing.
#pragma once

#include <optional>

#include "rt/extremal_moves.hpp"

namespace stillcut {

struct StretchedMove {
  ExtremalMove farthest, least;
  double share = 0.0;  // of the farthest, 0 to 1; at 1 the other does not count
};

// The move over the distance asked in exactly this time; nothing if there is none. Some durations above the least are
// impossible: the axis cannot dawdle where it moves too fast to wait, nor without time enough to turn back.
[[nodiscard]] std::optional<StretchedMove> move_of_duration(const AxisMove& move, double duration) noexcept;

// The least duration above this impossible one in which the move can be made.
[[nodiscard]] double next_possible_duration(const AxisMove& move, double duration) noexcept;

}  // namespace stillcut
