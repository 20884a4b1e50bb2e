// Units of forces and motions as instruments write them, in SI.
#pragma once

#include <optional>
#include <string_view>

#include "models/frequency_response.hpp"

namespace stillcut {

// N of one; nothing where the name is of no force.
[[nodiscard]] std::optional<double> force_unit(std::string_view name);

struct MotionUnit {
  double si = 1.0;                               // m, m/s or m/s^2
  ResponseKind kind = ResponseKind::receptance;  // of a motion in it over force
};

// Nothing where the name is of no motion.
[[nodiscard]] std::optional<MotionUnit> motion_unit(std::string_view name);

// m/s^2 of one; nothing where the name is of no acceleration.
[[nodiscard]] std::optional<double> acceleration_unit(std::string_view name);

}  // namespace stillcut
