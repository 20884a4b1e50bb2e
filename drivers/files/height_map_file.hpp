// Height maps in files: what Stillcut simulated for other programs, and what an instrument measured for Stillcut.
//   .csv  x_mm,y_mm,z_mm: x along the feed, y across it; z empty where nothing is known. Read and written.
//   .sdf  surface data file, ASCII (ISO 25178-71), which metrology programs read. Read and written: sdf_file.hpp.
//   .stl  triangles, binary, in mm, for CAD programs: an open surface, not a solid; nothing where a height is not
//   known.
//         Written only.
#pragma once

#include <filesystem>
#include <ostream>
#include <string>
#include <string_view>

#include "models/height_map.hpp"

namespace stillcut {

// By the name's ending. Throws InputError with file and line for what cannot be read, and for another ending.
[[nodiscard]] HeightMap read_height_map(const std::filesystem::path& file);
// Throws InputError for another ending, a map that the format has no room for, and a file that cannot be written.
void write_height_map(const HeightMap& map, const std::filesystem::path& file);

// Rows in any order; the grid is found in the places, which must be equally spaced within a twentieth of the spacing. A
// place without a row is not known. Throws InputError for a place that stands twice or lies off the grid, for fewer
// than two columns or rows of places, and where more than three quarters of the grid would have no row. `file`: the
// name used in messages.
[[nodiscard]] HeightMap parse_height_map_csv(std::string_view text, const std::string& file);

// Reading gives the same numbers to the last bit. Both throw std::invalid_argument for a map that is not sound or has
// fewer than two points in a direction.
void write_height_map_csv(std::ostream& out, const HeightMap& map);
void write_height_map_stl(std::ostream& out, const HeightMap& map);

}  // namespace stillcut
