// Pictures of a height map: heights in colours, relief, profiles, spectrum. Figures say what is to be seen and are
// drawn by plot::write_figure; the relief is drawn here.
#pragma once

#include <filesystem>
#include <string>

#include "models/height_map.hpp"
#include "tools/plot.hpp"

namespace stillcut {

// All take the least-squares plane off first, as roughness does, and throw std::invalid_argument where too little is
// known for one. Points not known stay white.

// Heights in µm over the feed and across it, drawn to scale.
[[nodiscard]] plot::Figure height_map_figure(const HeightMap& map, const std::string& title);

// The profiles along the feed and across it through the middle of the map.
[[nodiscard]] plot::Figure surface_profiles_figure(const HeightMap& map, const std::string& title);

// Mean spectra of all profiles along the feed and across it over the wavelength's reciprocal, with the intervals that
// stand out.
[[nodiscard]] plot::Figure surface_spectrum_figure(const HeightMap& map, const std::string& title);

// The surface seen from above at an angle, its heights enlarged so that they show, lit from the left. Throws InputError
// for a name that ends neither in .svg nor in .png and for a file that cannot be written.
void write_relief(const HeightMap& map, const std::string& title, const std::filesystem::path& file);

}  // namespace stillcut
