// The unit in which processors exchange memory. Data written by different threads is kept a line apart: on one line,
// each write of the one would delay the other (false sharing).
#pragma once

#include <cstddef>

namespace stillcut {

// Fixed, not std::hardware_destructive_interference_size: that one changes with the compiler's tuning flags.
inline constexpr std::size_t kCacheLine = 64;

}  // namespace stillcut
