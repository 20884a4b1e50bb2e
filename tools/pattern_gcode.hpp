// A pattern of a study as the program that cuts it.
#pragma once

#include <iosfwd>
#include <optional>

#include "tools/pattern_study.hpp"

namespace stillcut {

// The depth that is below the pattern's limit by the margin asked for, m.
double planned_depth(const PatternStudy& study, const RatedPattern& pattern);

// `depth`: how deep in all, m, in equal layers of at most the planned depth; without it one such layer. Z 0 is the
// part's top. A pattern that says no spindle speeds is cut at its common pocket's. Throws InputError for a path from a
// file, whose heights are its own, and where no depth is stable.
void write_pattern_gcode(const Cell& cell, const PatternStudy& study, const RatedPattern& pattern,
                         std::optional<double> depth, std::ostream& out);

}  // namespace stillcut
