// The member of one piece of a family of farthest moves that covers a distance. Between `low` and `high`, values of the
// piece's unknown, the distance must grow from below the one asked to above it, in that order.
//
// Divided by the jerk limit, as in extremal_moves.hpp. Pure functions, noexcept, allocate nothing.
#pragma once

#include "rt/extremal_moves.hpp"

namespace stillcut {

// Peak and trough free; the unknown is their difference.
[[nodiscard]] ExtremalMove root_free(const FarthestMoves& f, double distance, double low, double high) noexcept;
// Peak held; the unknown is the trough.
[[nodiscard]] ExtremalMove root_peak_held(const FarthestMoves& f, double distance, double low, double high) noexcept;
// Trough held; the unknown is for how long.
[[nodiscard]] ExtremalMove root_trough_held(const FarthestMoves& f, double distance, double low, double high) noexcept;
// Both held, without a cruise.
[[nodiscard]] ExtremalMove root_both_held(const FarthestMoves& f, double distance) noexcept;

}  // namespace stillcut
