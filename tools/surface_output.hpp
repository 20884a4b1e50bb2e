// How a studied surface is written: a table for people, JSON for programs.
#pragma once

#include <iosfwd>
#include <nlohmann/json_fwd.hpp>

#include "tools/surface_study.hpp"

namespace stillcut {

// `measured`: beside it, or null.
void print_surface(const StudiedSurface& study, const MeasuredSurface* measured, std::ostream& out);
nlohmann::ordered_json surface_json(const StudiedSurface& study, const MeasuredSurface* measured);

}  // namespace stillcut
