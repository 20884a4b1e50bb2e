// The surface that a tool path from a file leaves, for `stillcut surface --path`.
#pragma once

#include "tools/surface_study.hpp"

namespace stillcut {

// Sweeps the path of `study.question` with `study.tool` and fills in cells, map, figures and warnings; feed and spindle
// speed that the path leaves open are `study.cut`'s. Throws InputError, naming the path's file.
void study_path_surface(const SurfaceWatch& watch, StudiedSurface& study);

}  // namespace stillcut
