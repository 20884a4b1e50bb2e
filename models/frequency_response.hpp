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
  std::array<std::array<std::vector<double>, 3>, 3> coherence{};  // of measured entries, 0 to 1; empty: not known
  // What an exponential window added to the decay rate of every mode, 1/s: without_added_decay() (tap_estimate.hpp)
  // takes it off a mode that was fitted to these responses.
  double added_decay_per_s = 0.0;
  // Standard error of the force, relative, as far as many lines share it: the noise within a short force window, which
  // no line tells from the next. 0: not known, or none.
  double force_error = 0.0;
};

[[nodiscard]] std::size_t measured_entries(const FrequencyResponse& response);

// Throws std::invalid_argument for frequencies that do not rise or are below 0, for no measured entry, and for one that
// has another number of values than there are frequencies or a value that is not finite; likewise for coherence of what
// was not measured or beyond 0 to 1, and for an added decay
// or a force error below 0.
void require_sound_response(const FrequencyResponse& response);

// The columns of several responses of one point, measured for one direction of force after the other, as one. Throws
// std::invalid_argument where frequencies or added decay differ, or an entry is in two of them.
[[nodiscard]] FrequencyResponse joined_responses(std::span<const FrequencyResponse> parts);

// H/(i w)^n, n = 1 of mobility, 2 of accelerance. At 0 Hz nothing but a receptance is known: that value becomes NaN.
[[nodiscard]] ComplexValues receptance_of(ResponseKind kind, std::span<const double> frequencies_hz,
                                          std::span<const std::complex<double>> values);

}  // namespace stillcut
