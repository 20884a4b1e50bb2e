// One picture of what a cut leaves: heights, profiles and spectra; a measured surface beside it, in the same colours.
#pragma once

#include "tools/plot.hpp"
#include "tools/surface_study.hpp"

namespace stillcut {

// `measured`: beside it, or null. Throws std::invalid_argument where too little is known of a surface.
[[nodiscard]] plot::Figure surface_study_figure(const StudiedSurface& study, const MeasuredSurface* measured);

// What pictures of it are called: material, tool, cut.
[[nodiscard]] std::string surface_title(const StudiedSurface& study);

}  // namespace stillcut
