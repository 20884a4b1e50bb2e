// Which modes of two sets are the same physical mode: by how near they lie in frequency and in direction.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "models/dynamics_map.hpp"

namespace stillcut {

// Cosine of the angle between the directions of two modes.
double direction_cosine(const Mode& a, const Mode& b);

// Without unit: 0 for equal modes; an octave apart counts as much as a right angle between the directions, whose sign
// does not matter.
double mode_difference(const Mode& a, const Mode& b);

// For each mode of `of` the one of `in` that belongs to it, pairs taken best first, each mode in one pair at most;
// nothing where `in` has too few.
std::vector<std::optional<std::size_t>> pair_modes(std::span<const Mode> of, std::span<const Mode> in);

}  // namespace stillcut
