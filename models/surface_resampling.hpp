// A height map on another grid over the same area, as instruments and other programs have it.
#pragma once

#include <cstddef>

#include "models/height_map.hpp"

namespace stillcut {

// `along` x `across` points, the first and the last where the map's are; between four of the map's points the height is
// bilinear, nothing is averaged: what is finer than the new grid is not smoothed away, it shows up as a longer wave.
// Not known where one of the four that has a say is not. Throws std::invalid_argument for fewer than two points in a
// direction, of the map or asked for.
[[nodiscard]] HeightMap resampled(const HeightMap& map, std::size_t along, std::size_t across);

}  // namespace stillcut
