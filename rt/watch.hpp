// Watches of how long something has lasted, in data time: the time at which it began, 0 while it does not last.
#pragma once

#include <cstdint>

namespace stillcut {

[[nodiscard]] constexpr std::int64_t to_ns(double seconds) noexcept { return static_cast<std::int64_t>(seconds * 1e9); }

inline void run_watch(std::int64_t& since_ns, bool running, std::int64_t now_ns) noexcept {
  since_ns = !running ? 0 : since_ns == 0 ? now_ns : since_ns;
}
[[nodiscard]] inline bool has_run(std::int64_t since_ns, std::int64_t now_ns, std::int64_t long_ns) noexcept {
  return since_ns != 0 && now_ns - since_ns >= long_ns;
}

}  // namespace stillcut
