// The picture of stability lobes: limit depth over spindle speed, the chatter frequency below, and on top the cell's
// own cut and cuts that were measured or judged.
#pragma once

#include <span>

#include "tools/cut_points.hpp"
#include "tools/lobe_study.hpp"
#include "tools/plot.hpp"

namespace stillcut {

inline constexpr std::size_t kMostLobeCurves = 8;  // as many as there are colours to tell them apart

// At most kMostLobeCurves curves. Speeds without a limit are shaded, not drawn as numbers. `cuts_are` says in the
// legend where the verdicts of `cuts` come from.
plot::Figure lobe_figure(const LobeStudy& study, std::span<const MeasuredCut> cuts = {},
                         const std::string& cuts_are = "measured");

}  // namespace stillcut
