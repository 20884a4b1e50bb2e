// Pictures of a pattern study.
#pragma once

#include "tools/pattern_study.hpp"
#include "tools/plot.hpp"

namespace stillcut {

// The absolute stability index of the best patterns, as bars.
plot::Figure ranking_figure(const PatternStudy& study);

// The best direction at every location, outliers, and the patches of the plan.
plot::Figure field_figure(const PatternStudy& study);

// The lobes of all locations along the pattern, what they have in common, and its deepest pocket.
plot::Figure common_lobes_figure(const PatternStudy& study, const RatedPattern& pattern);

// The path, coloured by the margin a_lim/a - 1 at the depth (m) that it is cut at; moves that say no speed are judged
// at `spindle_speed` (rad/s).
plot::Figure path_figure(const PatternStudy& study, const RatedPattern& pattern, double axial_depth,
                         double spindle_speed);

}  // namespace stillcut
