// Measured frequency responses of the tool point: how far it moves along each axis for a force along each, over
// frequency. Receptance, m/N; what was measured as mobility or accelerance becomes it.
#pragma once

#include <array>
#include <complex>
#include <cstddef>
#include <span>
#include <vector>

namespace stillcut {

// Displacement, velocity and acceleration over force.
enum class ResponseKind { receptance, mobility, accelerance };

using ComplexValues = std::vector<std::complex<double>>;

struct FrequencyResponse {
  std::vector<double> frequencies_hz;                      // rising, from 0 up
  std::array<std::array<ComplexValues, 3>, 3> receptance;  // m/N, [response axis][force axis]; empty: not measured
};

[[nodiscard]] std::size_t measured_entries(const FrequencyResponse& response);

// Throws std::invalid_argument for frequencies that do not rise or are below 0, for no measured entry, and for one that
// has another number of values than there are frequencies or a value that is not finite.
void require_sound_response(const FrequencyResponse& response);

// H/(i w)^n, n = 1 of mobility, 2 of accelerance. At 0 Hz nothing but a receptance is known: that value becomes NaN.
[[nodiscard]] ComplexValues receptance_of(ResponseKind kind, std::span<const double> frequencies_hz,
                                          std::span<const std::complex<double>> values);

}  // namespace stillcut
