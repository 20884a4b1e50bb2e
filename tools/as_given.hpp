// Values as users gave them: without the rounding of the way to SI units and back.
#pragma once

#include <cmath>

#include "models/machining.hpp"

namespace stillcut {

inline double as_given(double value) { return std::round(value * 1e6) / 1e6; }
inline double as_given_mm(double metres) { return as_given(metres * 1e3); }
inline double as_given_deg(double angle) { return as_given(rad_to_deg(angle)); }
inline double as_given_rpm(double speed) { return as_given(rad_s_to_rpm(speed)); }

}  // namespace stillcut
