#include "models/surface_resampling.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

namespace stillcut {
namespace {

// Between `before` and `after`, this share of the way. The two are one point where a new point stands on an old one, so
// that a neighbour that is not known takes nothing from it.
struct Between {
  std::size_t before = 0, after = 0;
  double share = 0.0;
};

std::vector<Between> places_between(std::size_t from, std::size_t to) {
  std::vector<Between> places(to);
  for (std::size_t k = 0; k < to; ++k) {
    // Whole numbers first: where both grids have a point there is no rounding.
    const std::size_t scaled = k * (from - 1), cell = scaled / (to - 1), rest = scaled % (to - 1);
    places[k] = {cell, rest > 0 ? cell + 1 : cell, static_cast<double>(rest) / static_cast<double>(to - 1)};
  }
  return places;
}

double between(double before, double after, double share) { return before + share * (after - before); }

}  // namespace

HeightMap resampled(const HeightMap& map, std::size_t along, std::size_t across) {
  if (std::min({map.along, map.across, along, across}) < 2)
    throw std::invalid_argument("resampling: a surface needs two points in each direction");
  const std::vector<Between> x = places_between(map.along, along), y = places_between(map.across, across);
  HeightMap result{along, across,
                   map.spacing_along * static_cast<double>(map.along - 1) / static_cast<double>(along - 1),
                   map.spacing_across * static_cast<double>(map.across - 1) / static_cast<double>(across - 1),
                   std::vector<double>(along * across)};
  for (std::size_t j = 0; j < across; ++j)
    for (std::size_t i = 0; i < along; ++i)
      result.at(i, j) =
          between(between(map.at(x[i].before, y[j].before), map.at(x[i].after, y[j].before), x[i].share),
                  between(map.at(x[i].before, y[j].after), map.at(x[i].after, y[j].after), x[i].share), y[j].share);
  return result;
}

}  // namespace stillcut
