// The form of a profile or surface by least squares, which roughness leaves out: what is tilted or bent, not rough.
// Heights that are NaN are not known: they have no say in the form and stay NaN.
#pragma once

#include <span>

#include "models/height_map.hpp"

namespace stillcut {

enum class SurfaceForm { linear, quadratic };  // line or plane; polynomial of order two

// Takes the form off a profile. Throws std::invalid_argument where fewer points are known than would show anything
// beside the form (three for a line), and for an infinite height.
void remove_form(std::span<double> profile, SurfaceForm form);

// The same of a map: plane, or all terms up to order two. Throws std::invalid_argument also where the known points lie
// so that they tell no such form, as on one line.
void remove_form(HeightMap& map, SurfaceForm form);

}  // namespace stillcut
