// A dynamics map for the six areas, which the paper does not print: fitted, and labelled as such.
#pragma once

#include <array>
#include <optional>

#include "models/dynamics_map.hpp"
#include "tests/surface_study/published.hpp"

namespace stillcut::surface_study {

// Where the areas lie on the workpiece of 100 x 80 mm is not printed either: nine strips along X, one above the other,
// the areas a quarter, a half and three quarters along theirs, away from the robot's base from A to C and D to F.
[[nodiscard]] std::array<double, 3> area_place(std::size_t area);  // m
[[nodiscard]] std::array<double, 3> case_middle(int number);       // m, of a case's strip

// As in eq. 24 one mode a direction, the same for the three: frequency and damping are the map's, the stiffness an
// area's own.
struct AreaModes {
  double frequency_hz = 0.0, damping_ratio = 0.0;
};
[[nodiscard]] std::vector<Mode> modes_of(const AreaModes& modes, double stiffness);  // N/m

// The areas' postures with their modes, without the one that is left out.
[[nodiscard]] DynamicsMap area_map(const AreaModes& modes, const std::array<double, kAreas>& stiffness,
                                   std::optional<std::size_t> left_out = {});

// What the map says of a place: inverse distance weighting (eqs 16-18) of modal parameters.
[[nodiscard]] std::vector<Mode> modes_at(const DynamicsMap& map, const std::array<double, 3>& place);
[[nodiscard]] inline std::vector<Mode> predicted_modes(const DynamicsMap& map, std::size_t area) {
  return modes_at(map, area_place(area));
}

}  // namespace stillcut::surface_study
