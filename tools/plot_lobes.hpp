// The picture of stability lobes: limit depth over spindle speed, the chatter frequency below, and on top the cell's
// own cut and cuts that were measured or judged.
#pragma once

#include <span>
#include <string>

#include "tools/cut_points.hpp"
#include "tools/lobe_study.hpp"
#include "tools/plot.hpp"

namespace stillcut {

inline constexpr std::size_t kMostLobeCurves = 8;  // as many as there are colours to tell them apart

// What the legend says of cuts that are stable, near the limit and unstable.
struct CutLabels {
  std::string stable, near_limit, unstable;
};
inline const CutLabels kMeasuredCuts{"measured: stable", "measured: marginal", "measured: chatter"};
inline const CutLabels kPredictedCuts{"predicted: stable", "predicted: near the limit", "predicted: unstable"};

// At most kMostLobeCurves curves. Speeds without a limit are shaded, not drawn as numbers.
plot::Figure lobe_figure(const LobeStudy& study, std::span<const MeasuredCut> cuts = {},
                         const CutLabels& labels = kMeasuredCuts);

}  // namespace stillcut
