// Units of force and acceleration as instruments write them, in SI.
#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <utility>

namespace stillcut {

// N of one; nothing where the name is of no force.
[[nodiscard]] constexpr std::optional<double> force_unit(std::string_view name) {
  constexpr std::array<std::pair<std::string_view, double>, 4> kUnits{
      {{"N", 1.0}, {"mN", 1e-3}, {"kN", 1e3}, {"lbf", 4.4482216152605}}};
  for (const auto& [unit, si] : kUnits)
    if (name == unit) return si;
  return {};
}

// m/s^2 of one; nothing where the name is of no acceleration.
[[nodiscard]] constexpr std::optional<double> acceleration_unit(std::string_view name) {
  constexpr std::array<std::pair<std::string_view, double>, 9> kUnits{{{"m/s^2", 1.0},
                                                                       {"m/s2", 1.0},
                                                                       {"m/s**2", 1.0},
                                                                       {"m/s\xC2\xB2", 1.0},
                                                                       {"mm/s^2", 1e-3},
                                                                       {"mm/s2", 1e-3},
                                                                       {"in/s^2", 0.0254},
                                                                       {"g", 9.80665},
                                                                       {"G", 9.80665}}};
  for (const auto& [unit, si] : kUnits)
    if (name == unit) return si;
  return {};
}

}  // namespace stillcut
