// Surface data files (SDF, ISO 25178-71), ASCII: what MountainsMap, Gwyddion and other metrology programs read and
// write. NumPoints points of a profile, here along the feed, Xscale m apart; NumProfiles profiles, Yscale m apart;
// heights times Zscale are m; BAD where nothing is known.
#pragma once

#include <ostream>
#include <string>
#include <string_view>

#include "models/height_map.hpp"

namespace stillcut {

// aISO-1.0, aISO-2.0 and the older aBCR-1.0. What follows the heights is not read. Throws InputError with the line for
// a binary or compressed file, a header that lacks a number or has one that cannot be, and too few or too many heights.
// `file`: the name used in messages.
[[nodiscard]] HeightMap parse_sdf(std::string_view text, const std::string& file);

// As aISO-1.0, heights in m with Zscale 1: reading gives the same numbers to the last bit. The dates say 1970, so that
// the same map is the same file. Throws std::invalid_argument for a map that is not sound or has more than 65535 points
// in a direction, for which the format has no room.
void write_sdf(std::ostream& out, const HeightMap& map);

}  // namespace stillcut
