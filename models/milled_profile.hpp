// Roughness along the feed of what a simulated cut leaves, as a stylus would have it: the wall of an end mill
// (models/wall_heights), the floor of a ball end (models/floor_heights). Each sampling length is a profile by itself.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "models/surface_roughness.hpp"

namespace stillcut {

inline constexpr double kSamplingLength = 0.8e-3;  // m; ISO 4288, R_a 0.1 to 2 um

// How far into the part it is cut at `count` points, `spacing` apart from `from` on, m; NaN: not known.
using MilledHeights = std::function<std::vector<double>(double from, double spacing, std::size_t count)>;

struct MilledLength {
  double from = 0.0;                          // m along the feed, where it begins
  std::optional<ProfileRoughness> roughness;  // m; empty where some of it is not known
};

// The sampling lengths from `begin` on that end by `end`; where they are more than `most`, every second, third, ...
// one.
[[nodiscard]] std::vector<MilledLength> milled_lengths(const MilledHeights& heights, double begin, double end,
                                                       std::size_t most = SIZE_MAX);

// Mean over those that are known; empty where none is.
[[nodiscard]] std::optional<ProfileRoughness> mean_of(std::span<const MilledLength> lengths);

}  // namespace stillcut
