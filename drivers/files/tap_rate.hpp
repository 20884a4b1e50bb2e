// The sample rate of times in a file. For the readers of recordings.
#pragma once

#include <cstddef>
#include <span>

namespace stillcut {

// In Hz, whole where the digits of the times allow it; 0 where there are fewer than two, or where a step is off the
// mean by half of it: `uneven` is then the later time's index.
[[nodiscard]] double even_rate_hz(std::span<const double> times_s, std::size_t& uneven);

}  // namespace stillcut
