// What stands where no number can.
#pragma once

#include <limits>

namespace stillcut {

inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();      // not known
inline constexpr double kInfinity = std::numeric_limits<double>::infinity();  // without bound

}  // namespace stillcut
