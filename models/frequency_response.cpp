#include "models/frequency_response.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "dsp/numbers.hpp"
#include "models/machining.hpp"
#include "models/sentence.hpp"

namespace stillcut {

std::size_t measured_entries(const FrequencyResponse& response) {
  std::size_t count = 0;
  for (const auto& row : response.receptance)
    for (const ComplexValues& entry : row) count += entry.empty() ? 0 : 1;
  return count;
}

void require_sound_response(const FrequencyResponse& response) {
  const std::vector<double>& hz = response.frequencies_hz;
  for (std::size_t i = 0; i < hz.size(); ++i)
    if (!std::isfinite(hz[i]) || hz[i] < 0.0 || (i > 0 && hz[i] <= hz[i - 1]))
      throw std::invalid_argument("frequencies must rise, from 0 up");
  if (hz.empty() || measured_entries(response) == 0)
    throw std::invalid_argument("a frequency response needs frequencies and a measured entry");
  for (const auto& row : response.receptance)
    for (const ComplexValues& entry : row) {
      if (!entry.empty() && entry.size() != hz.size())
        throw std::invalid_argument("every measured entry needs a value at each frequency");
      for (const std::complex<double>& value : entry)
        if (!std::isfinite(value.real()) || !std::isfinite(value.imag()))
          throw std::invalid_argument("a value of a frequency response is not finite");
    }
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (std::size_t force = 0; force < 3; ++force) {
      const std::vector<double>& coherence = response.coherence[axis][force];
      if (coherence.empty()) continue;
      if (response.receptance[axis][force].empty() || coherence.size() != hz.size() ||
          !std::ranges::all_of(coherence, [](double value) { return value >= 0.0 && value <= 1.0; }))
        throw std::invalid_argument("coherence must be from 0 to 1, at each frequency of a measured entry");
    }
  if (!(response.added_decay_per_s >= 0.0) || !std::isfinite(response.added_decay_per_s))
    throw std::invalid_argument("the decay that a window added must be from 0 1/s up");
  if (!(response.force_error >= 0.0) || !std::isfinite(response.force_error))
    throw std::invalid_argument("the error of the force must be from 0 up");
}

FrequencyResponse joined_responses(std::span<const FrequencyResponse> parts) {
  if (parts.empty()) throw std::invalid_argument("no frequency response was given");
  FrequencyResponse joined = parts.front();
  for (const FrequencyResponse& part : parts.subspan(1)) {
    joined.force_error = std::max(joined.force_error, part.force_error);
    if (part.frequencies_hz != joined.frequencies_hz)
      throw std::invalid_argument("frequencies differ: use the same sample rate and record length for every direction");
    if (part.added_decay_per_s != joined.added_decay_per_s)
      throw std::invalid_argument("exponential windows differ: use the same one for every direction");
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (std::size_t force = 0; force < 3; ++force) {
        if (part.receptance[axis][force].empty()) continue;
        if (!joined.receptance[axis][force].empty())
          throw std::invalid_argument(sentence("response ", "xyz"[axis], " to force ", "xyz"[force],
                                               " was measured twice: give the recordings of a direction together"));
        joined.receptance[axis][force] = part.receptance[axis][force];
        joined.coherence[axis][force] = part.coherence[axis][force];
      }
  }
  return joined;
}

ComplexValues receptance_of(ResponseKind kind, std::span<const double> frequencies_hz,
                            std::span<const std::complex<double>> values) {
  ComplexValues result(values.begin(), values.end());
  if (kind == ResponseKind::receptance) return result;
  for (std::size_t i = 0; i < result.size(); ++i) {
    const double w = kTwoPi * frequencies_hz[i];
    if (w == 0.0)
      result[i] = {kNaN, kNaN};
    else if (kind == ResponseKind::mobility)
      result[i] = std::complex<double>(result[i].imag(), -result[i].real()) / w;
    else
      result[i] /= -(w * w);
  }
  return result;
}

}  // namespace stillcut
