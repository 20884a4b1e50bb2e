// Random frequency responses for the tests of their files.
#pragma once

#include <cmath>
#include <random>

#include "models/frequency_response.hpp"

namespace stillcut {

inline FrequencyResponse random_response(std::mt19937_64& random) {
  const auto below = [&](std::size_t n) { return std::uniform_int_distribution<std::size_t>(0, n - 1)(random); };
  const auto number = [&] {
    const double exponent = std::uniform_real_distribution<>(-12.0, 3.0)(random);
    return std::copysign(std::pow(10.0, exponent), std::uniform_real_distribution<>(-1.0, 1.0)(random));
  };
  FrequencyResponse response;
  const std::size_t points = 1 + below(40);
  const bool even = below(2) == 0;
  double hz = even ? 0.5 * static_cast<double>(below(8)) : std::uniform_real_distribution<>(0.1, 9.0)(random);
  for (std::size_t i = 0; i < points; ++i) {
    response.frequencies_hz.push_back(hz);
    hz += even ? 0.25 : std::uniform_real_distribution<>(0.1, 9.0)(random);
  }
  for (auto& row : response.receptance)
    for (ComplexValues& entry : row)
      if (below(3) == 0)
        for (std::size_t i = 0; i < points; ++i) entry.emplace_back(number(), number());
  if (measured_entries(response) == 0) response.receptance[below(3)][below(3)].assign(points, {number(), number()});
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (std::size_t force = 0; force < 3; ++force)
      if (!response.receptance[axis][force].empty() && below(2) == 0)
        for (std::size_t i = 0; i < points; ++i)
          response.coherence[axis][force].push_back(std::uniform_real_distribution<>(0.0, 1.0)(random));
  if (below(2) == 0) response.added_decay_per_s = std::uniform_real_distribution<>(0.1, 9.0)(random);
  if (below(2) == 0) response.force_error = std::uniform_real_distribution<>(1e-5, 1e-2)(random);
  return response;
}

}  // namespace stillcut
