// The tool paths that a pattern study ranks: patterns over the cell's region, and files; and whether what was measured
// covers them.
#pragma once

#include <vector>

#include "models/path_patterns.hpp"
#include "tools/pattern_study.hpp"

namespace stillcut {

// How the cell's cut fills its region.
PatternSettings pattern_settings(const Cell& cell, const PatternQuestion& question);

// All of them, each told where it goes among the places; not rated. `angles` of zig and zig-zag in rad. Throws
// InputError: no region and no file, a fault in either, a path that cuts nowhere in the plane.
std::vector<RatedPattern> paths_to_rank(const Cell& cell, const PatternQuestion& question,
                                        const std::vector<double>& angles, const std::vector<Eigen::Vector2d>& places);

// The locations that any of the paths comes to.
std::vector<std::size_t> used_locations(const std::vector<RatedPattern>& patterns);

// Throws InputError for a path that leaves the places' surroundings: `reach` (m), or models/places over those used.
void check_covered(const std::vector<RatedPattern>& patterns, const std::vector<Eigen::Vector2d>& places,
                   std::optional<double> reach);

// What a reader of the ranking has to know of the paths, a line each.
std::vector<std::string> path_warnings(const Cell& cell, const PatternQuestion& question,
                                       const std::vector<RatedPattern>& patterns);

}  // namespace stillcut
