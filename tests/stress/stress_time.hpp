// How long a stress test goes on: STILLCUT_STRESS_S seconds, two where that is not set.
#pragma once

#include <chrono>
#include <cstdlib>

namespace stillcut::test {

inline std::chrono::duration<double> stress_time() {
  const char* seconds = std::getenv("STILLCUT_STRESS_S");
  return std::chrono::duration<double>{seconds != nullptr ? std::atof(seconds) : 2.0};
}

// Calls `act` over and over until that time is over.
template <typename Action>
void stress(Action act) {
  const auto end = std::chrono::steady_clock::now() + stress_time();
  while (std::chrono::steady_clock::now() < end) act();
}

}  // namespace stillcut::test
